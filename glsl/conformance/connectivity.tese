#version 460

// Hands on its tess coordinates. Domain, spacing, order and point mode are execution modes, which the host rewrites in the module.

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_patch;
layout(location = 0) flat out uint out_patch;
layout(location = 1) out vec3 out_coordinate;

void main() {
    out_patch = in_patch;
    out_coordinate = gl_TessCoord;
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
