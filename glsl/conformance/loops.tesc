#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/loops.glsl"

layout(vertices = 32) out;

layout(location = 0) in uint in_vertex[];
layout(location = 0) patch out uint out_patch;

void main() {
    uint number = in_vertex[0] * 32u + uint(gl_InvocationID);
    sums[number] = sum_of(number, 1u + term(number) % 20u);
    out_patch = in_vertex[0];
    for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = 1.0;
    for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = 1.0;
}
