#version 460

// Stands for the control shader where another stage reads: validation takes what a module names for what it uses.

layout(vertices = 1) out;

layout(location = 0) in uint in_number[];
layout(location = 0) patch out uint out_number;

void main() {
    out_number = in_number[0];
    for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = 1.0;
    for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = 1.0;
}
