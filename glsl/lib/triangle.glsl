// Triangles whose control points are computed points. Twin of `method/triangles.rs`.
#ifndef TRIANGLE_GLSL
#define TRIANGLE_GLSL

#include "lib/points.glsl"

// The weights of corner 0, 1 and 2 at (u, v).
vec3 corner_weights(vec2 uv) {
    precise vec3 weights = vec3((1.0 - uv.x) - uv.y, uv.x, uv.y);
    return weights;
}

// On an edge only two of three corners count, or one of three edges: so both sides have the same bits.
vec3 sum_of_three(vec3 weights, vec3 a, vec3 b, vec3 c) {
    precise vec3 sum = (weights.x * a + weights.y * b) + weights.z * c;
    return sum;
}

// Whether the surface has one normal at (u, v) for all its faces.
bool has_one_normal(Patch record, vec2 uv) {
    bvec3 on = lessThanEqual(corner_weights(uv).zxy, vec3(0.0));
    uint place = on.x && on.z ? 3u : on.x && on.y ? 4u : on.y && on.z ? 5u : on.x ? 0u : on.y ? 1u : on.z ? 2u : 6u;
    return place == 6u || (record.flags & (PATCH_CREASED << place)) == 0u;
}

#ifdef STAGE_VERTEX
// The control shader fetches points itself.
vec3 control_point(Patch record, uint number) { return vec3(0.0); }
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, uv, 1.0); }
#endif

#endif
