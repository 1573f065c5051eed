#version 460

// 1 for fronts, 2 for backs, as a colour of 24 bits.

layout(location = 0) out vec4 out_colour;

void main() {
    out_colour = vec4(gl_FrontFacing ? 1.0 : 2.0, 0.0, 0.0, 255.0) / 255.0;
}
