#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/loops.glsl"

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_patch;
layout(location = 0) flat out uint out_patch;

// Eight vertices in a row.
void main() {
    uvec2 place = uvec2(gl_TessCoord.xy * 7.0 + 0.5);
    uint number = in_patch * 64u + place.y * 8u + place.x;
    sums[number] = sum_of(number, 1u + term(number) % 20u);
    out_patch = in_patch;
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
