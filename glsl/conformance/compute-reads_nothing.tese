#version 460

// Stands for the evaluation shader where another stage reads.

layout(quads, equal_spacing, ccw) in;

void main() {
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
