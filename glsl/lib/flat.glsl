// The normals of flat patches. Twin of `method/flat.rs`.
#ifndef FLAT_LIB_GLSL
#define FLAT_LIB_GLSL

#include "lib/surface.glsl"

// Of two differences of points, each of which was rounded once; `greatest` is their greatest coordinate.
vec3 flat_normal(vec3 du, vec3 dv, float greatest) {
    precise float error = 4.0 * ROUNDING * greatest;
    return clear_normal(Tangents(du, dv, vec2(error)));
}

#endif
