// A control shader fills a slot of memory, the evaluation shader of the same patch reads it: what both forms of it share.
//
// Before this is included, the form defines CONTROL_MEMORY and EVALUATION_MEMORY, the qualifiers of the slots' memory in each stage, and
// MAKE_VISIBLE, what stands between stores or loads and the barrier; and, where these are not plain ones, STORE, LOAD and BARRIER.
#ifndef VISIBILITY_GLSL
#define VISIBILITY_GLSL

#extension GL_EXT_scalar_block_layout : require

#ifdef STAGE_CONTROL
#define SLOT_MEMORY CONTROL_MEMORY
#else
#define SLOT_MEMORY EVALUATION_MEMORY
#endif

layout(set = 0, binding = 0, scalar) SLOT_MEMORY buffer Slots { uint words[]; };
layout(set = 0, binding = 1, scalar) coherent buffer Counters { uint taken[]; };
layout(set = 0, binding = 2, scalar) buffer Results {
    // Words compared, words that were wrong, patches that found no room, the first wrong word's patch, number and value.
    uint compared;
    uint wrong;
    uint refused;
    uint first_patch;
    uint first_number;
    uint first_value;
} results;

// Twin of `visibility::Constants`.
layout(push_constant, scalar) uniform Draw {
    // The first patch, and words a patch.
    uint first_patch;
    uint words;
    // Words that the slots' memory has room for.
    uint room;
    // The counter of this batch.
    uint counter;
    // 1 when the host gives slots: number * words.
    uint host;
    // What this batch writes differs from all others.
    uint round;
    // What the reader expects differs by this: 0, unless a fault is seeded.
    uint fault;
    float level;
} draw;

#ifndef STORE
#define STORE(at, value) words[at] = value
#endif
#ifndef LOAD
#define LOAD(at) words[at]
#endif
#ifndef BARRIER
#define BARRIER barrier()
#endif

const uint NO_SLOT = 0xffffffffu;

// A word that tells patch, place and round apart (the finaliser of MurmurHash3).
uint content(uint number, uint place, uint round) {
    uint x = number * 0x9e3779b9u + place * 0x85ebca6bu + round * 0xc2b2ae35u + 1u;
    x = (x ^ x >> 16u) * 0x7feb352du;
    x = (x ^ x >> 15u) * 0x846ca68bu;
    return x ^ x >> 16u;
}

#endif
