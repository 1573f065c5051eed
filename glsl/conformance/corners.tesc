#version 460

// A patch a vertex, so that many are in one instance; levels are 1.

layout(vertices = 1) out;

layout(location = 0) in uint in_vertex[];
layout(location = 0) patch out uint out_patch;

void main() {
    out_patch = in_vertex[0];
    for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = 1.0;
    for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = 1.0;
}
