// Quads whose control points are the points of their vertices. Twin of `method/quads.rs`.
#ifndef QUAD_GLSL
#define QUAD_GLSL

#include "lib/points.glsl"

// The weights of the four corners at (u, v).
vec4 quad_weights(vec2 uv) {
    precise float s = 1.0 - uv.x;
    precise float t = 1.0 - uv.y;
    precise vec4 weights = vec4(s * t, uv.x * t, uv.x * uv.y, s * uv.y);
    return weights;
}

// What they change by with u, and with v.
vec4 weights_by_u(vec2 uv) {
    precise float t = 1.0 - uv.y;
    return vec4(-t, t, uv.y, -uv.y);
}
vec4 weights_by_v(vec2 uv) {
    precise float s = 1.0 - uv.x;
    return vec4(-s, -uv.x, uv.x, s);
}

// On an edge only two of four corners count, or one of four edges: so both sides have the same bits, be the other a quad or a triangle.
vec3 sum_of_four(vec4 weights, vec3 a, vec3 b, vec3 c, vec3 d) {
    precise vec3 sum = ((weights.x * a + weights.y * b) + weights.z * c) + weights.w * d;
    return sum;
}

// Pieces have all of this in a way of their own.
#ifndef PIECES
// A vertex has one.
bool has_one_normal(Patch record, vec2 uv) { return true; }

#ifdef STAGE_VERTEX
// The control shader fetches points itself.
vec3 control_point(Patch record, uint number) { return vec3(0.0); }
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, uv, 1.0); }
#endif
#endif

#endif
