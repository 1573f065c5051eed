// Invocations of a control shader that read in each round what their neighbours wrote in the one before.
#ifndef BARRIERS_GLSL
#define BARRIERS_GLSL

#extension GL_EXT_scalar_block_layout : require

// Control points in, and invocations.
layout(constant_id = 0) const uint POINTS = 1u;
layout(constant_id = 1) const uint INVOCATIONS = 1u;
// Where words stand: 0 in an output of each vertex, 1 in an array of the patch, 2 in positions, 3 in a buffer, 4 in components of the patch's vectors.
layout(constant_id = 2) const uint FORM = 0u;
// Whether the vertex shader stores into a buffer as well.
layout(constant_id = 3) const uint STORES = 0u;

const uint ROUNDS = 4u;
const uint MOST = 32u;
// An array of the patch has no more locations than this.
const uint LOCATIONS = 16u;

layout(set = 0, binding = 0, scalar) buffer Results {
    // Words compared, words that were wrong, and of one of these its patch, its place and what it was.
    uint compared;
    uint wrong;
    uint first_patch;
    uint first_place;
    uint first_word;
} results;
// A word a vertex of a patch.
layout(set = 0, binding = 1, scalar) coherent buffer Words { uint words[]; };
// How often the vertex shader ran for each control point.
layout(set = 0, binding = 2, scalar) buffer Stored { uint stored[]; };

layout(push_constant, scalar) uniform Draw { uint fault; };

// Below 2^24: whole numbers stay whole in floats.
const uint PRIME = 8191u;

uint first_word(uint number, uint self) {
    return (number * 97u + self * 31u + 5u) % PRIME;
}

uint next_word(uint own, uint left, uint right) {
    return (own + 3u * left + 5u * right + 1u) % PRIME;
}

#endif
