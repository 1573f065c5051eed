// Words that a compute shader writes, and that a stage of a later draw reads.
#ifndef COMPUTE_GLSL
#define COMPUTE_GLSL

#extension GL_EXT_scalar_block_layout : require

// Words a patch.
const uint WORDS = 16u;

layout(set = 0, binding = 0, scalar) buffer Words { uint words[]; };
layout(set = 0, binding = 1, scalar) buffer Results {
    // Words compared, words that were wrong, and one of these by its number and what it was.
    uint compared;
    uint wrong;
    uint first_number;
    uint first_word;
} results;

// Twin of `compute_visibility::Constants`.
layout(push_constant, scalar) uniform Draw {
    uint count;
    uint round;
    // What is read is expected to be of this round.
    uint expected;
} draw;

// A word that tells place and round apart (the finaliser of MurmurHash3).
uint content(uint place, uint round) {
    uint x = place * 0x85ebca6bu + round * 0xc2b2ae35u + 1u;
    x = (x ^ x >> 16u) * 0x7feb352du;
    x = (x ^ x >> 15u) * 0x846ca68bu;
    return x ^ x >> 16u;
}

void read_patch(uint number) {
    for (uint i = 0u; i < WORDS; ++i) {
        uint place = number * WORDS + i;
        uint found = words[place];
        atomicAdd(results.compared, 1u);
        if (found != content(place, draw.expected)) {
            atomicAdd(results.wrong, 1u);
            results.first_number = place;
            results.first_word = found;
        }
    }
}

#endif
