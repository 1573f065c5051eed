// Edges and corners of patches, which all faces there evaluate alike. Twin of `method/quadtree/twin.rs`.
#ifndef BORDER_GLSL
#define BORDER_GLSL

#include "lib/interface.glsl"
#include "lib/surface.glsl"

// Where a point of a patch lies: 0 inside, 1 + edge, or 5 + corner.
struct Place {
    uint number;
    // On an edge: how far along it, counter-clockwise, and what is left of it.
    vec2 along;
};

// t and 1 - t, exchanged if `backwards`. The smaller of both is exact: so both directions have the same pair.
vec2 turned_round(float t, bool backwards) {
    precise float other = 1.0 - t;
    float small = t > 0.5 ? other : t;
    precise vec2 pair = vec2(small, 1.0 - small);
    return (t > 0.5) != backwards ? pair.yx : pair;
}

Place find_place(uint flags, vec2 uv) {
    bvec2 low = lessThanEqual(uv, vec2(0.0));
    bvec2 high = greaterThanEqual(uv, vec2(1.0));
    uint corner = high.y ? (high.x ? 2u : 3u) : (high.x ? 1u : 0u);
    // Corners 1 and 3 of an n-gon's part are the middles of edges.
    bool middle = (flags & PATCH_HALF) != 0u && (corner & 1u) == 1u;
    bool at_corner = (low.x || high.x) && (low.y || high.y) && !middle;
    uint edge = low.y ? 1u : low.x ? 4u : high.x ? 2u : high.y ? 3u : 0u;
    bool along_u = low.y || (high.y && !low.x && !high.x);
    vec2 along = turned_round(along_u ? uv.x : uv.y, edge >= 3u);
    return Place(at_corner ? 5u + corner : edge, along);
}

// From along a patch's edge to along the whole edge in its own direction.
float on_edge(uint flags, vec2 along) {
    precise vec2 whole = along;
    if ((flags & USE_FIRST_HALF) != 0u) whole = vec2(0.5 * along.x, 0.5 + 0.5 * along.y);
    if ((flags & USE_SECOND_HALF) != 0u) whole = vec2(0.5 + 0.5 * along.x, 0.5 * along.y);
    return (flags & USE_FLIPPED) != 0u ? whole.y : whole.x;
}

// Derivatives in the patch's frame, from one that is turned by so many quarters.
Surface turned(Surface surface, uint quarters) {
    vec3 du = (quarters & 1u) != 0u ? -surface.dv : surface.du;
    vec3 dv = (quarters & 1u) != 0u ? surface.du : surface.dv;
    bool back = quarters >= 2u;
    return Surface(surface.position, back ? -du : du, back ? -dv : dv);
}

#endif
