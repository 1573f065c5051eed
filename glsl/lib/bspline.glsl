// The uniform cubic B-spline. Twin of `patch::bspline`.
#ifndef BSPLINE_GLSL
#define BSPLINE_GLSL

#include "lib/surface.glsl"

struct Basis {
    vec4 value;
    vec4 derivative;
};

Basis bspline_basis(float t) {
    float s = 1.0 - t;
    const float sixth = 1.0 / 6.0;
    return Basis(
        vec4(s * s * s * sixth, (4.0 + t * t * (3.0 * t - 6.0)) * sixth, (4.0 + s * s * (3.0 * s - 6.0)) * sixth,
             t * t * t * sixth),
        vec4(-0.5 * s * s, t * (1.5 * t - 2.0), s * (2.0 - 1.5 * s), 0.5 * t * t));
}

// Adds row y of a patch, whose four points are a, b, c, d.
void add_row(inout Surface surface, Basis u, float value, float derivative, vec3 a, vec3 b, vec3 c, vec3 d) {
    vec3 row = u.value.x * a + u.value.y * b + u.value.z * c + u.value.w * d;
    vec3 row_du = u.derivative.x * a + u.derivative.y * b + u.derivative.z * c + u.derivative.w * d;
    surface.position += value * row;
    surface.du += value * row_du;
    surface.dv += derivative * row;
}

#endif
