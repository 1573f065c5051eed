// The level of half an edge beside an n-gon, see `patch_levels`. Twin of `half` in `tessellation/levels.rs`.
#ifndef HALF_LEVEL_GLSL
#define HALF_LEVEL_GLSL

#include "abi.glsl"

float half_level(float level, bool fractional_even) {
    precise float halved = fractional_even ? 2.0 * ceil(level * 0.25) : ceil(level * 0.5);
    return halved;
}

// How often the edges of the control mesh are halved to make those of a patch: once for a part of an n-gon, and as often as a piece's depth says.
// Twin of `halvings` in `tessellation/levels.rs`.
uint patch_halvings(Patch record) {
    bool piece = (record.flags >> PATCH_CHILD_SHIFT & 15u) == CHILD_PIECE;
    uint depth = piece ? record.plan >> PIECE_DEPTH_SHIFT : 0u;
    return (record.flags & PATCH_HALF) != 0u ? depth + 1u : depth;
}

float halved_level(float level, uint halvings, bool fractional_even) {
    for (uint i = 0u; i < halvings; ++i) level = half_level(level, fractional_even);
    return level;
}

#endif
