// Quadratic approximation of subdivision surfaces (Boubekeur, Schlick 2007). Twin of `method/qas.rs`.
#ifndef QAS_GLSL
#define QAS_GLSL

#define TRIANGLES

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"

const uint CONTROL_POINTS = 1u;
// Positions at the corners and on the edges from corner i to corner i + 1, then normals.
#define CONTROL_VERTICES 12

#ifdef STAGE_CONTROL
// Such that the middle of the edge is `middle`: c110 = (4 e - p0 - p1) / 2 (section 2.3).
vec3 edge_control(vec3 middle, vec3 a, vec3 b) {
    precise vec3 point = 2.0 * middle - 0.5 * (a + b);
    return point;
}

vec3 patch_point(Patch record, uint number) {
    uint i = number % 6u;
    Point own = patch_control(record, i);
    Point a = patch_control(record, i % 3u);
    Point b = patch_control(record, (i + 1u) % 3u);
    bool normals = number >= 6u;
    vec3 point = normals ? own.normal : own.position;
    if (i < 3u) return point;
    return edge_control(point, normals ? a.normal : a.position, normals ? b.normal : b.position);
}
#endif

#ifdef STAGE_EVALUATION
vec3 quadratic(uint first, vec3 squares, vec3 pairs) {
    precise vec3 sum = sum_of_three(squares, in_point[first], in_point[first + 1u], in_point[first + 2u]) +
                       2.0 * sum_of_three(pairs, in_point[first + 3u], in_point[first + 4u], in_point[first + 5u]);
    return sum;
}

// Half of the derivative of the position by weight i, the three being free.
vec3 by_weight(uint i, vec3 w) {
    uint j = (i + 1u) % 3u;
    uint k = (i + 2u) % 3u;
    precise vec3 sum = w[i] * in_point[i] + (w[j] * in_point[3u + i] + w[k] * in_point[3u + k]);
    return sum;
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec3 w = corner_weights(uv);
    if (TANGENTS) {
        vec3 by_first = by_weight(0u, w);
        keep_tangents(2.0 * (by_weight(1u, w) - by_first), 2.0 * (by_weight(2u, w) - by_first));
    }
    precise vec3 squares = w * w;
    precise vec3 pairs = w * w.yzx;
    return Point(quadratic(0u, squares, pairs), unit(quadratic(6u, squares, pairs)));
}
#endif

#endif
