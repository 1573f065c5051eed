// Gregory quads, whose points stand in `in_point` as in `lib/gregory.glsl`: CORNERS, NEAR, FAR, INSIDE_NEAR and INSIDE_FAR. Twin of `method/blended.rs`.
#ifndef BLENDED_QUAD_GLSL
#define BLENDED_QUAD_GLSL

#include "lib/bicubic.glsl"
#include "lib/blended.glsl"
#include "lib/quad.glsl"

#ifdef STAGE_EVALUATION
Blended inner_point(uint i, float a, float b) { return blended(a, b, in_point[INSIDE_NEAR + i], in_point[INSIDE_FAR + ((i + 3u) & 3u)]); }

// Position and derivatives as they are inside.
Surface blended_quad(vec2 uv) {
    float u = uv.x;
    float v = uv.y;
    precise float s = 1.0 - u;
    precise float t = 1.0 - v;
    // From corner i along edge i, and along edge i - 1.
    Blended f0 = inner_point(0u, u, v);
    Blended f1 = inner_point(1u, v, s);
    Blended f2 = inner_point(2u, s, t);
    Blended f3 = inner_point(3u, t, u);
    Surface surface = bicubic(Inner(f0.mean, f1.mean, f2.mean, f3.mean), uv);
    // What the inner points themselves change by.
    vec4 weights = quad_weights(uv);
    precise float inside = 9.0 * ((s * u) * (t * v));
    precise vec4 by_u = weights * vec4(v, v, -t, -t);
    precise vec4 by_v = weights * vec4(-u, s, s, -u);
    precise vec3 du = surface.du + inside * sum_of_four(by_u, f0.change, f1.change, f2.change, f3.change);
    precise vec3 dv = surface.dv + inside * sum_of_four(by_v, f0.change, f1.change, f2.change, f3.change);
    return Surface(surface.position, du, dv);
}
#endif

#endif
