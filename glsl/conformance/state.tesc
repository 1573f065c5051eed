#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/state.glsl"

layout(vertices = 1) out;

layout(location = 0) in uint in_number[];
layout(location = 0) patch out uint out_number;

void main() {
    atomicMax(counts[draw.number].points, uint(gl_PatchVerticesIn));
    out_number = in_number[POINTS - 1u];
    for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = draw.level;
    for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = draw.level;
}
