#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/views.glsl"

layout(vertices = 1) out;

layout(location = 0) in uint in_colour[];
layout(location = 0) patch out uint out_colour;

void main() {
    out_colour = in_colour[0] + part(1u);
    float own = level + float(2u * view_in(1u));
    for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = own;
    for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = own;
}
