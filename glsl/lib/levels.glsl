// Tess levels of a patch, a function of its edges alone on each edge. Twin of `tessellation::levels`.
#ifndef LEVELS_GLSL
#define LEVELS_GLSL

#include "lib/interface.glsl"

// Levels of the edges from corner i to corner i + 1, and of the inside.
struct Levels {
    vec4 edges;
    float inside;
};

// Where a quad meets an n-gon, its edge gets twice the segments of the n-gon's half edge, so that both have a vertex in the middle and all
// vertices line up: 2k and k with equal spacing, 4k and 2k with fractional-even (Brainerd et al. 2016, section 7.2).
Levels patch_levels(Patch record, float greatest) {
    float level = clamp(frame.level, 1.0, greatest);
    bool fractional_even = (frame.flags & FRAME_FRACTIONAL_EVEN) != 0u;
    float half_level = fractional_even ? 2.0 * ceil(level * 0.25) : ceil(level * 0.5);
    if ((record.flags & PATCH_HALF) != 0u) return Levels(vec4(half_level), half_level);
    vec4 edges;
    for (uint i = 0u; i < 4u; ++i) {
        bool even = (record.flags & (PATCH_EVEN_EDGE << i)) != 0u;
        edges[i] = even ? 2.0 * half_level : level;
    }
    return Levels(edges, level);
}

// The level that stencils are needed for: ceil(log2 of the greatest factor).
uint required_level(Levels levels, uint deepest) {
    float greatest = max(levels.inside, max(max(levels.edges.x, levels.edges.y), max(levels.edges.z, levels.edges.w)));
    uint level = 0u;
    while (level < deepest && float(1u << level) < greatest) ++level;
    return level;
}

#endif
