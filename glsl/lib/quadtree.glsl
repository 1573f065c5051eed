// Plans and the walk through their quadtrees (Brainerd et al. 2016, section 6.1). Twin of `plan::walk`.
#ifndef QUADTREE_GLSL
#define QUADTREE_GLSL

#include "lib/crease.glsl"
#include "lib/interface.glsl"

// The method's own tables, in this order.
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer NodeTable { uvec3 node_words[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer PointTable { uvec2 point_rows[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer StencilTable { uvec2 stencils[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer WeightTable { float weights[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer PatternTable { uint patterns[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer UseTable { Use uses[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer EndTable { Ends ends[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer BorderTable { Border borders[]; };

// Where the border of a patch is, and what it is evaluated by at some place.
uint border_of(Patch record) { return bases.own[7] + record.plan; }
uint use_of(Patch record, uint number) { return bases.own[5] + borders[border_of(record)].uses[number]; }

// The row of a stencil: what it is relative to, where its set of weights begins, and where its pattern, in units of four bits.
struct StencilRow {
    uint corner;
    uint set;
    uint pattern;
    uint width;
    uint mask;
#ifndef LONG_RINGS
    // The words of the pattern, each for four to eight terms of a sum: so a term fetches nothing but its weight.
    uvec4 first_words;
    uvec4 last_words;
#endif
};

// That of a ring of `size` vertices.
StencilRow stencil_row(uint number, uint size) {
    uvec2 row = stencils[bases.own[2] + number];
    StencilRow found;
    found.corner = row.x >> STENCIL_SHIFT;
    found.set = bases.own[3] + (row.x & ((1u << STENCIL_SHIFT) - 1u));
    found.pattern = row.y & ((1u << WIDTH_SHIFT) - 1u);
    found.width = min(row.y >> WIDTH_SHIFT, 2u);
    found.mask = (1u << (4u << found.width)) - 1u;
#ifndef LONG_RINGS
    uint word = bases.own[4] + (found.pattern >> 3u);
    found.pattern &= 7u;
    found.last_words = uvec4(0u);
    // Few have more than four. Behind the last pattern there are other tables.
    found.first_words = uvec4(patterns[word], patterns[word + 1u], patterns[word + 2u], patterns[word + 3u]);
    if (found.pattern + (size << found.width) > 32u) {
        found.last_words = uvec4(patterns[word + 4u], patterns[word + 5u], patterns[word + 6u], patterns[word + 7u]);
    }
#endif
    return found;
}

// The word of its pattern in which four bits stand.
uint pattern_word(StencilRow row, uint at) {
#ifdef LONG_RINGS
    return patterns[bases.own[4] + (at >> 3u)];
#else
    uvec4 four = (at & 32u) != 0u ? row.last_words : row.first_words;
    uvec2 two = (at & 16u) != 0u ? four.zw : four.xy;
    return (at & 8u) != 0u ? two.y : two.x;
#endif
}

// Where the weights of a dense row begin.
uint dense_row(uint number) { return bases.own[3] + (stencils[bases.own[2] + number].x & ((1u << STENCIL_SHIFT) - 1u)); }

// The weight of a vertex of the ring, in a row that is not dense.
float weight_at(StencilRow row, uint place) {
    uint at = row.pattern + (place << row.width);
    return weights[row.set + (pattern_word(row, at) >> (4u * (at & 7u)) & row.mask)];
}

// The row of points that begins at `number` in the nodes' lists: two 16-bit halves a word, the lower first.
uvec4 node_row(uint number) {
    uvec2 row = point_rows[bases.own[1] + (number >> 2u)];
    return uvec4(row.x & 0xffffu, row.x >> 16u, row.y & 0xffffu, row.y >> 16u);
}

// A node, fetched at once.
Node node_at(uint number) {
    uvec3 three = node_words[bases.own[0] + number];
    return Node(three.x, three.y, uintBitsToFloat(three.z));
}

// Where a walk ends: in a B-spline. NODE_EXTRAORDINARY has no points: no tess coordinate inside gets there.
struct Leaf {
    uint points;
    vec2 uv;
    float scale;
    uint edge;
    float sharpness;
    // What its points are relative to: the number of a stencil plus 1, and the use of the corner whose vertex that is relative to; 0 for none.
    uint base;
    uint origin;
    uint kind;
};

// Levels around an extraordinary vertex: the level is floor(-log2) of the larger distance from it, read off the float's exponent. Along an edge each is one
// B-spline.
Leaf terminal_leaf(Leaf leaf, uint levels) {
    uint corner = leaf.edge;
    vec2 uv = leaf.uv;
    bvec2 at = bvec2(corner == 1u || corner == 2u, corner >= 2u);
    precise vec2 other = 1.0 - uv;
    vec2 from_corner = mix(uv, other, at);
    uint exponent = floatBitsToUint(max(from_corner.x, from_corner.y)) >> 23u;
    uint level = 126u - min(exponent, 126u);
    if (level >= levels) return Leaf(0u, vec2(0.0), leaf.scale, corner, 0.0, 0u, 0u, NODE_EXTRAORDINARY);
    float grown = power_of_two(int(level));
    precise vec2 local = from_corner * grown;
    bvec2 child = notEqual(greaterThanEqual(local, vec2(0.5)), at);
    precise vec2 beyond = 1.0 - local;
    precise vec2 inside = 2.0 * mix(local, beyond, at) - vec2(child);
    precise float whole = leaf.scale * grown * 2.0;
    bool along = leaf.kind == NODE_CURVE_TERMINAL;
    uint number = uint(child.x) + 2u * uint(child.y) - uint(at.x) - 2u * uint(at.y) - 1u;
    uint place = along ? 16u * level : TERMINAL_POINTS * level + 16u * (number & 3u);
    return Leaf(leaf.points + place, inside, whole, 0u, 0.0, leaf.base, leaf.origin, along ? NODE_REGULAR : NODE_TERMINAL);
}

// The tree of an edge is walked along v = 0.
Leaf find_leaf(uint root, vec2 from) {
    precise vec2 uv = from;
    // On a split plane the half nearer to the patch's middle is taken; at the middle itself the upper one.
    bvec2 upper = greaterThanEqual(uv, vec2(0.5));
    Node node = node_at(root);
    precise float scale = 1.0;
    // Bounded: helper invocations of fragment shaders may read zeros, which look like an internal node (seen on llvmpipe, Mesa 22.3.6).
    for (uint depth = 0u; depth <= HIGHEST_LEVEL + 2u && (node.kind & 15u) == NODE_INTERNAL; ++depth) {
        bvec2 inner_tie = bvec2(scale > 1.0 && upper.x, scale > 1.0 && upper.y);
        bvec2 half_plane = mix(greaterThanEqual(uv, vec2(0.5)), greaterThan(uv, vec2(0.5)), inner_tie);
        uv = 2.0 * uv - vec2(half_plane);
        scale *= 2.0;
        node = node_at(node.points + uint(half_plane.x) + 2u * uint(half_plane.y));
    }
    uint kind = node.kind & 15u;
    uint place = node.kind >> 4u & 15u;
    uint base = node.kind >> NODE_BASE_SHIFT & 15u;
    uint origin = node.kind >> NODE_ORIGIN_SHIFT & 15u;
    Leaf leaf = Leaf(node.points, uv, scale, place, node.sharpness, base, origin, kind);
    if (kind == NODE_TERMINAL || kind == NODE_CURVE_TERMINAL) return terminal_leaf(leaf, node.kind >> 8u & 255u);
    return leaf;
}

#endif
