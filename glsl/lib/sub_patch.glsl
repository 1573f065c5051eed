// Patches with more segments than a tessellator makes: they are cut into pieces, each of which is drawn by itself. Twin of `tessellation/sub_patch.rs`, which
// says why nothing opens.
#ifndef SUB_PATCH_GLSL
#define SUB_PATCH_GLSL

#include "lib/interface.glsl"
#include "lib/levels.glsl"
#include "lib/unit.glsl"

// The record of what is drawn under a number, where patches are cut.
uint sub_patch_at(uint number) { return min(number, frame.end_patch - 1u); }

// The levels of the whole patch.
Levels whole_levels(uint number, uint view, Patch record) {
    if (!are_sub_patches()) return patch_levels(number, view, record);
    uint at = sub_patch_at(number);
    return Levels(sub_patches[at].edges, sub_patches[at].inside);
}

// What the tessellator is given of them.
Levels tessellated_levels(uint number, Levels levels) {
    if (!are_sub_patches()) return levels;
    uint depth = sub_patches[sub_patch_at(number)].piece >> PIECE_DEPTH_SHIFT;
    precise float level = levels.inside * power_of_two(-int(depth));
    return depth == 0u ? levels : Levels(vec4(level), level);
}

#ifndef TRIANGLES
// Where vertex `i` of an edge's is; where two patches lie beyond, each of them counts by itself.
float vertex_place(uint i, uint segments, bool halved) {
    uint half_segments = halved ? segments / 2u : segments;
    bool second = i > half_segments;
    precise float t = step_of(second ? i - half_segments : i, half_segments);
    if (halved) t = second ? 0.5 + 0.5 * t : 0.5 * t;
    return t;
}

// Where (u, v) of a piece lies in its patch.
vec2 piece_coordinates(Patch record, Levels levels, uint piece, vec2 uv) {
    uint depth = piece >> PIECE_DEPTH_SHIFT;
    bool cut = depth > 0u;
    precise float level = levels.inside * power_of_two(-int(depth));
    uint segments = uint(level);
    uint lattice = segments << depth;
    precise vec2 steps = uv * float(segments) + 0.5;
    uvec2 vertex = uvec2(piece, piece >> PIECE_ROW_SHIFT) % (1u << PIECE_ROW_SHIFT) * segments + uvec2(steps);
    bvec2 low = cut ? equal(vertex, uvec2(0u)) : lessThanEqual(uv, vec2(0.0));
    bvec2 high = cut ? equal(vertex, uvec2(lattice)) : greaterThanEqual(uv, vec2(1.0));
    if (!any(low) && !any(high)) return cut ? vec2(step_of(vertex.x, lattice), step_of(vertex.y, lattice)) : uv;
    uint edge = low.y ? 0u : high.y ? 2u : low.x ? 3u : 1u;
    bool along_v = (edge & 1u) != 0u;
    uint on_edge = uint(levels.edges[edge]);
    precise float own = (along_v ? uv.y : uv.x) * float(on_edge) + 0.5;
    uint nearest = cut ? (2u * (along_v ? vertex.y : vertex.x) * on_edge + lattice) / (2u * lattice) : uint(own);
    float t = vertex_place(nearest, on_edge, (record.flags & (PATCH_EVEN_EDGE << edge)) != 0u);
    return along_v ? vec2(high.x ? 1.0 : 0.0, t) : vec2(t, high.y ? 1.0 : 0.0);
}
#endif

#endif
