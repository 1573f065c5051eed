// Gregory triangles (Loop, Schaefer, Ni, Castano 2009). Twin of `method/gregory.rs`.
#ifndef GREGORY_GLSL
#define GREGORY_GLSL

#define TRIANGLES

const uint CORNERS = 3u;
#define CONTROL_VERTICES 15

#include "lib/gregory.glsl"
#include "lib/triangle.glsl"

#ifdef STAGE_EVALUATION
Blended inner_point(uint i, float a, float b) { return blended(a, b, in_point[INSIDE_NEAR + i], in_point[INSIDE_FAR + ((i + 2u) % 3u)]); }

// What edge i has but for its share.
vec3 edge_sum(uint i, vec3 w) {
    precise vec3 sum = w[i] * in_point[NEAR + i] + w[(i + 1u) % 3u] * in_point[FAR + i];
    return sum;
}

// The derivative by weight i, the three being free: over edge i, which leaves the corner, over edge i - 1, which comes to it, and over what lies inside.
vec3 by_weight(uint i, vec3 w, vec3 lengths, vec3 shares, vec3 inner, float product, vec3 own, vec3 turning) {
    uint j = (i + 1u) % 3u;
    uint k = (i + 2u) % 3u;
    precise vec3 corner = (3.0 * (w[i] * w[i])) * in_point[i];
    precise vec3 leaving = (w[j] * (lengths[i] + w[i])) * edge_sum(i, w) + shares[i] * in_point[NEAR + i];
    precise vec3 coming = (w[k] * (lengths[k] + w[i])) * edge_sum(k, w) + shares[k] * in_point[FAR + k];
    precise vec3 around = leaving + coming;
    precise vec3 turned = (w[j] * w[k]) * turning;
    precise vec3 inside = (12.0 * (w[j] * w[k])) * inner + product * (own + turned);
    precise vec3 sum = (corner + 3.0 * around) + inside;
    return sum;
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec3 w = corner_weights(uv);
    Blended f0 = inner_point(0u, w.y, w.z);
    Blended f1 = inner_point(1u, w.z, w.x);
    Blended f2 = inner_point(2u, w.x, w.y);
    // Of the edge from corner i to corner i + 1; lengths are exactly 1 on it.
    precise vec3 lengths = 1.0 - w.zxy;
    precise vec3 shares = (w * w.yzx) * lengths;
    precise vec3 cubes = (w * w) * w;
    vec3 inner = sum_of_three(w, f0.mean, f1.mean, f2.mean);
    precise float product = 12.0 * ((w.x * w.y) * w.z);
    precise vec3 position = (sum_of_three(cubes, in_point[0], in_point[1], in_point[2]) +
                             3.0 * sum_of_three(shares, edge_sum(0u, w), edge_sum(1u, w), edge_sum(2u, w))) +
                            product * inner;
    precise vec3 turning_0 = f2.change - f1.change;
    precise vec3 turning_1 = f0.change - f2.change;
    precise vec3 turning_2 = f1.change - f0.change;
    vec3 by_0 = by_weight(0u, w, lengths, shares, inner, product, f0.mean, turning_0);
    precise vec3 du = by_weight(1u, w, lengths, shares, inner, product, f1.mean, turning_1) - by_0;
    precise vec3 dv = by_weight(2u, w, lengths, shares, inner, product, f2.mean, turning_2) - by_0;
    bvec3 on = lessThanEqual(w.zxy, vec3(0.0));
    uint corner = on.x && on.z ? 0u : on.x && on.y ? 1u : on.y && on.z ? 2u : 3u;
    uint edge = on.x ? 0u : on.y ? 1u : on.z ? 2u : 3u;
    uint from = edge % 3u;
    return on_border(record, Surface(position, du, dv), edge, corner, vec2(w[from], w[(from + 1u) % 3u]));
}
#endif

#endif
