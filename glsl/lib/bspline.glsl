// The uniform cubic B-spline. Twin of `patch::bspline`.
#ifndef BSPLINE_GLSL
#define BSPLINE_GLSL

#include "lib/surface.glsl"

struct Basis {
    vec4 value;
    vec4 derivative;
};

// The basis at t, where s is 1 - t. With both exchanged it is the same basis from the other end, bit by bit.
Basis bspline_basis_of(float t, float s) {
    const float sixth = 1.0 / 6.0;
    precise vec4 value = vec4(s * s * s * sixth, (4.0 + t * t * (3.0 * t - 6.0)) * sixth,
                              (4.0 + s * s * (3.0 * s - 6.0)) * sixth, t * t * t * sixth);
    precise vec4 derivative = vec4(-0.5 * s * s, t * (1.5 * t - 2.0), s * (2.0 - 1.5 * s), 0.5 * t * t);
    return Basis(value, derivative);
}

Basis bspline_basis(float t) {
    precise float s = 1.0 - t;
    return bspline_basis_of(t, s);
}

// Sum of four weighted points, the same bits from either end: on edges and at corners one of the outer weights is zero, and the others are
// symmetric about the second or third point.
vec3 blend(vec4 w, vec3 a, vec3 b, vec3 c, vec3 d) {
    precise vec3 sum = (w.x * a + w.z * c) + (w.y * b + w.w * d);
    return sum;
}

// A row of a patch: its points along u, and their derivative.
struct Row {
    vec3 value;
    vec3 derivative;
};

Row bspline_row(Basis u, vec3 a, vec3 b, vec3 c, vec3 d) {
    return Row(blend(u.value, a, b, c, d), blend(u.derivative, a, b, c, d));
}

// The surface of four rows, v across them.
Surface bspline_surface(Basis v, float scale, Row a, Row b, Row c, Row d) {
    precise vec3 du = scale * blend(v.value, a.derivative, b.derivative, c.derivative, d.derivative);
    precise vec3 dv = scale * blend(v.derivative, a.value, b.value, c.value, d.value);
    return Surface(blend(v.value, a.value, b.value, c.value, d.value), du, dv);
}

#endif
