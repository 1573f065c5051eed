// PN quads (Peters 2008). Twin of `method/pn.rs`.
#ifndef PN_QUADS_GLSL
#define PN_QUADS_GLSL

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"
#include "lib/pn_edge.glsl"
#include "lib/quad.glsl"
#include "lib/surface.glsl"

const uint CONTROL_POINTS = 1u;
// Corners, the points next to corner i and to corner i + 1 on the edge between them, those inside next to corner i; normals at corners,
// between them and in the centre.
#define CONTROL_VERTICES 25
const uint NEAR = 4u;
const uint FAR = 8u;
const uint INSIDE = 12u;
const uint NORMALS = 16u;
const uint BETWEEN = 20u;
const uint CENTRE = 24u;

#ifdef STAGE_CONTROL
const float NINTH = 1.0 / 9.0;

Point corner(Patch record, uint i) { return patch_control(record, i & 3u); }

// The mean of both edge points next to corner i.
vec3 beside(Patch record, uint i) {
    Point a = corner(record, i);
    precise vec3 mean = 0.5 * (edge_point(a, corner(record, i + 1u)) + edge_point(a, corner(record, i + 3u)));
    return mean;
}

// The bilinear patch of four points, a third of the way from the first to its neighbours.
vec3 third_of_the_way(vec3 a, vec3 b, vec3 c, vec3 d) {
    precise vec3 point = NINTH * ((4.0 * a + 2.0 * (b + d)) + c);
    return point;
}

// E + (E - V) / 2: V of the corners, E of the means beside them.
vec3 inner_point(Patch record, uint i) {
    vec3 mean = third_of_the_way(beside(record, i), beside(record, i + 1u), beside(record, i + 2u), beside(record, i + 3u));
    vec3 corners = third_of_the_way(corner(record, i).position, corner(record, i + 1u).position, corner(record, i + 2u).position,
                                    corner(record, i + 3u).position);
    precise vec3 inner = mean + 0.5 * (mean - corners);
    return inner;
}

// The mean of the corners and that of the edges' normals, in shares of a third and two thirds.
vec3 centre_normal(Patch record) {
    Point a = corner(record, 0u);
    Point b = corner(record, 1u);
    Point c = corner(record, 2u);
    Point d = corner(record, 3u);
    vec3 corners = sum_of_four(vec4(1.0), a.normal, b.normal, c.normal, d.normal);
    vec3 edges = sum_of_four(vec4(1.0), edge_normal(a, b), edge_normal(b, c), edge_normal(c, d), edge_normal(d, a));
    precise vec3 centre = (0.25 * THIRD) * (corners + 2.0 * edges);
    return centre;
}

vec3 patch_point(Patch record, uint number) {
    if (number == CENTRE) return centre_normal(record);
    Point a = corner(record, number);
    Point b = corner(record, number + 1u);
    if (number < NEAR) return a.position;
    if (number < FAR) return edge_point(a, b);
    if (number < INSIDE) return edge_point(b, a);
    if (number < NORMALS) return inner_point(record, number);
    if (number < BETWEEN) return a.normal;
    return edge_normal(a, b);
}
#endif

#include "lib/bicubic.glsl"

#ifdef STAGE_EVALUATION
// What an edge from corner i to corner i + 1 adds, apart from its weight.
vec3 edge_sum(uint i, float near, float far) {
    precise vec3 sum = near * in_point[NEAR + i] + far * in_point[FAR + i];
    return sum;
}

vec3 sum_of_points(uint first, vec4 weights) {
    return sum_of_four(weights, in_point[first], in_point[first + 1u], in_point[first + 2u], in_point[first + 3u]);
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    if (TANGENTS) {
        Surface surface = bicubic(Inner(in_point[INSIDE], in_point[INSIDE + 1u], in_point[INSIDE + 2u], in_point[INSIDE + 3u]), uv);
        keep_tangents(surface.du, surface.dv);
    }
    precise float s = 1.0 - uv.x;
    precise float t = 1.0 - uv.y;
    // Across edge i; at corner i edges i and i - 1 meet.
    vec4 across = vec4(t, uv.x, uv.y, s);
    precise vec2 pair = vec2(s * uv.x, t * uv.y);
    precise vec4 squares = across * across;
    precise vec4 cubes = squares * across;
    precise vec4 corner_squares = squares * squares.wxyz;
    precise vec4 corner_cubes = cubes * cubes.wxyz;
    precise vec4 edge_squares = pair.xyxy * squares;
    precise vec4 edge_cubes = pair.xyxy * cubes;
    precise float middle = pair.x * pair.y;
    vec3 around = sum_of_four(edge_cubes, edge_sum(0u, s, uv.x), edge_sum(1u, t, uv.y), edge_sum(2u, uv.x, s), edge_sum(3u, uv.y, t));
    precise vec3 inside = (9.0 * middle) * sum_of_points(INSIDE, quad_weights(uv));
    precise vec3 position = (sum_of_points(0u, corner_cubes) + 3.0 * around) + inside;
    precise vec3 normal = (sum_of_points(NORMALS, corner_squares) + sum_of_points(BETWEEN, edge_squares)) + middle * in_point[CENTRE];
    return Point(position, unit(normal));
}
#endif

#endif
