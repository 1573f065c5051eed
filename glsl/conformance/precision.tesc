#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/precision.glsl"

layout(vertices = 1) out;

layout(location = 0) in uint in_number[];
layout(location = 0) patch out uint out_number;

void main() {
    evaluate(1u, in_number[0]);
    out_number = in_number[0];
    for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = 1.0;
    for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = 1.0;
}
