#version 460

// Has its patch's number and its tess coordinates captured. Domain, spacing, order and point mode are execution modes, which the host rewrites in
// the module.

layout(quads, equal_spacing, ccw) in;

layout(xfb_buffer = 0, xfb_stride = 16) out;

layout(location = 0) patch in uint in_patch;
layout(location = 0, xfb_buffer = 0, xfb_offset = 0) flat out uint out_patch;
layout(location = 1, xfb_buffer = 0, xfb_offset = 4) out vec3 out_coordinate;

void main() {
    out_patch = in_patch;
    out_coordinate = gl_TessCoord;
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
