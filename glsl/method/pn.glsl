// Curved PN triangles (Vlachos, Peters, Boyd, Mitchell 2001). Twin of `method/pn.rs`.
#ifndef PN_GLSL
#define PN_GLSL

#define TRIANGLES

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"
#include "lib/pn_edge.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"

const uint CONTROL_POINTS = 1u;
// Corners, the points next to corner i and to corner i + 1 on the edge between them, the middle; normals at corners and between them.
#define CONTROL_VERTICES 16
const uint NEAR = 3u;
const uint FAR = 6u;
const uint MIDDLE = 9u;
const uint NORMALS = 10u;
const uint BETWEEN = 13u;

#ifdef STAGE_CONTROL
// E + (E - V) / 2 of the mean of the points on the edges and that of the corners.
vec3 middle_point(Point a, Point b, Point c) {
    precise vec3 edges =
        ((edge_point(a, b) + edge_point(b, a)) + (edge_point(b, c) + edge_point(c, b))) + (edge_point(c, a) + edge_point(a, c));
    precise vec3 mean = (0.5 * THIRD) * edges;
    precise vec3 middle = mean + 0.5 * (mean - THIRD * ((a.position + b.position) + c.position));
    return middle;
}

vec3 patch_point(Patch record, uint number) {
    if (number == MIDDLE) return middle_point(patch_control(record, 0u), patch_control(record, 1u), patch_control(record, 2u));
    uint i = number < MIDDLE ? number % 3u : (number - NORMALS) % 3u;
    Point a = patch_control(record, i);
    Point b = patch_control(record, (i + 1u) % 3u);
    if (number < NEAR) return a.position;
    if (number < FAR) return edge_point(a, b);
    if (number < MIDDLE) return edge_point(b, a);
    if (number < BETWEEN) return a.normal;
    return edge_normal(a, b);
}
#endif

#ifdef STAGE_EVALUATION
// What an edge from corner i to corner i + 1 adds, apart from the product of both weights.
vec3 edge_sum(uint i, float near, float far) {
    precise vec3 sum = near * in_point[NEAR + i] + far * in_point[FAR + i];
    return sum;
}

// The derivative by weight i, the three being free: over edge i, which leaves the corner, over edge k, which comes to it, and over the middle.
vec3 by_weight(uint i, vec3 w) {
    uint j = (i + 1u) % 3u;
    uint k = (i + 2u) % 3u;
    precise vec3 leaving = w[j] * (2.0 * w[i] * in_point[NEAR + i] + w[j] * in_point[FAR + i]);
    precise vec3 coming = w[k] * (w[k] * in_point[NEAR + k] + 2.0 * w[i] * in_point[FAR + k]);
    precise vec3 sum = 3.0 * ((w[i] * w[i]) * in_point[i] + (leaving + coming)) + (6.0 * (w[j] * w[k])) * in_point[MIDDLE];
    return sum;
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec3 w = corner_weights(uv);
    if (TANGENTS) {
        vec3 by_first = by_weight(0u, w);
        keep_tangents(by_weight(1u, w) - by_first, by_weight(2u, w) - by_first);
    }
    precise vec3 pairs = w * w.yzx;
    precise vec3 squares = w * w;
    precise vec3 cubes = squares * w;
    vec3 corners = sum_of_three(cubes, in_point[0], in_point[1], in_point[2]);
    vec3 around = sum_of_three(pairs, edge_sum(0u, w.x, w.y), edge_sum(1u, w.y, w.z), edge_sum(2u, w.z, w.x));
    precise vec3 inside = (6.0 * (pairs.x * w.z)) * in_point[MIDDLE];
    precise vec3 position = (corners + 3.0 * around) + inside;
    precise vec3 normal = sum_of_three(squares, in_point[NORMALS], in_point[NORMALS + 1u], in_point[NORMALS + 2u]) +
                          sum_of_three(pairs, in_point[BETWEEN], in_point[BETWEEN + 1u], in_point[BETWEEN + 2u]);
    return Point(position, unit(normal));
}
#endif

#endif
