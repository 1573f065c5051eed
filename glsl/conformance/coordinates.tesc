#version 460
#extension GL_EXT_scalar_block_layout : require

// A patch an instance, with tess levels from a table.

layout(vertices = 1) out;

layout(location = 0) in uint in_vertex[];
layout(location = 1) in uint in_instance[];
layout(location = 0) patch out uint out_patch;

struct TessLevels {
    float outer[4];
    float inner[2];
};
layout(set = 0, binding = 0, scalar) readonly buffer LevelTable { TessLevels table[]; };

void main() {
    uint number = in_instance[0];
    out_patch = number;
    for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = table[number].outer[i];
    for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = table[number].inner[i];
}
