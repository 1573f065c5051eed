#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/views.glsl"

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_colour;
layout(location = 0) flat out uint out_colour;

void main() {
    uint view = view_in(2u);
    atomicAdd(runs[view], 1u);
    out_colour = in_colour + part(2u);
    // Smaller in each view. Lines on the picture's edge would be drawn in no pixel.
    vec2 place = (gl_TessCoord.xy + 0.0625) * (1.0 - 0.1 * float(view));
    gl_Position = vec4(1.75 * place - 1.0, 0.0, 1.0);
}
