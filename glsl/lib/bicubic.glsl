// Bicubic patches whose points stand in `in_point` by corners and edges: CORNERS, NEAR and FAR as in `lib/gregory.glsl`. Twin of `method/bicubic.rs`.
#ifndef BICUBIC_GLSL
#define BICUBIC_GLSL

#include "lib/quad.glsl"
#include "lib/surface.glsl"

#ifdef STAGE_EVALUATION
// The points inside, by the nearest corner.
struct Inner {
    vec3 a;
    vec3 b;
    vec3 c;
    vec3 d;
};

// Where a point lies: on an edge, and at a corner, or 4.
struct Spot {
    uint edge;
    uint corner;
    vec2 along;
};

Spot quad_spot(vec2 uv) {
    precise vec2 rest = 1.0 - uv;
    bvec4 on = bvec4(uv.y <= 0.0, uv.x >= 1.0, uv.y >= 1.0, uv.x <= 0.0);
    uint corner = on.x && on.w ? 0u : on.x && on.y ? 1u : on.y && on.z ? 2u : on.z && on.w ? 3u : 4u;
    if (on.x) return Spot(0u, corner, vec2(rest.x, uv.x));
    if (on.y) return Spot(1u, corner, vec2(rest.y, uv.y));
    if (on.z) return Spot(2u, corner, vec2(uv.x, rest.x));
    if (on.w) return Spot(3u, corner, vec2(uv.y, rest.y));
    return Spot(4u, 4u, vec2(0.0));
}

// The position; an edge has no terms but its own.
vec3 bicubic_position(Inner inner, vec2 uv) {
    float u = uv.x;
    float v = uv.y;
    precise float s = 1.0 - u;
    precise float t = 1.0 - v;
    // Across edge i; at corner i edges i and i - 1 meet.
    vec4 across = vec4(t, u, v, s);
    precise vec2 pair = vec2(s * u, t * v);
    precise vec4 cubes = (across * across) * across;
    precise vec4 at_corners = cubes * cubes.wxyz;
    precise vec4 at_edges = pair.xyxy * cubes;
    precise vec3 edge_0 = s * in_point[NEAR] + u * in_point[FAR];
    precise vec3 edge_1 = t * in_point[NEAR + 1u] + v * in_point[FAR + 1u];
    precise vec3 edge_2 = u * in_point[NEAR + 2u] + s * in_point[FAR + 2u];
    precise vec3 edge_3 = v * in_point[NEAR + 3u] + t * in_point[FAR + 3u];
    precise float inside = 9.0 * (pair.x * pair.y);
    precise vec3 position = (sum_of_four(at_corners, in_point[0], in_point[1], in_point[2], in_point[3]) +
                             3.0 * sum_of_four(at_edges, edge_0, edge_1, edge_2, edge_3)) +
                            inside * sum_of_four(quad_weights(uv), inner.a, inner.b, inner.c, inner.d);
    return position;
}

vec3 cubic_derivative(vec3 a, vec3 b, vec3 c, vec3 d, float s, float u) {
    precise vec3 sum = (s * s) * (b - a) + ((2.0 * (s * u)) * (c - b) + (u * u) * (d - c));
    return sum;
}

vec4 cubic_weights(float t, float v) {
    precise vec4 weights = vec4((t * t) * t, 3.0 * ((t * t) * v), 3.0 * (t * (v * v)), (v * v) * v);
    return weights;
}

// The position with its derivatives, the inner points standing still.
Surface bicubic(Inner inner, vec2 uv) {
    float u = uv.x;
    float v = uv.y;
    precise float s = 1.0 - u;
    precise float t = 1.0 - v;
    vec3 i0 = inner.a;
    vec3 i1 = inner.b;
    vec3 i2 = inner.c;
    vec3 i3 = inner.d;
    vec3 n0 = in_point[NEAR];
    vec3 n1 = in_point[NEAR + 1u];
    vec3 n2 = in_point[NEAR + 2u];
    vec3 n3 = in_point[NEAR + 3u];
    vec3 f0 = in_point[FAR];
    vec3 f1 = in_point[FAR + 1u];
    vec3 f2 = in_point[FAR + 2u];
    vec3 f3 = in_point[FAR + 3u];
    precise vec3 du = 3.0 * sum_of_four(cubic_weights(t, v), cubic_derivative(in_point[0], n0, f0, in_point[1], s, u),
                                        cubic_derivative(f3, i0, i1, n1, s, u), cubic_derivative(n3, i3, i2, f1, s, u),
                                        cubic_derivative(in_point[3], f2, n2, in_point[2], s, u));
    precise vec3 dv = 3.0 * sum_of_four(cubic_weights(s, u), cubic_derivative(in_point[0], f3, n3, in_point[3], t, v),
                                        cubic_derivative(n0, i0, i3, f2, t, v), cubic_derivative(f0, i1, i2, n2, t, v),
                                        cubic_derivative(in_point[1], n1, f1, in_point[2], t, v));
    return Surface(bicubic_position(inner, uv), du, dv);
}
#endif

#endif
