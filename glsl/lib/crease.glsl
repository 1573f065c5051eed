// The cubic B-spline across one semi-sharp crease (Nießner, Loop, Greiner 2012), as weights (Brainerd et al. 2016, section 6.2).
// Twin of `patch::crease`, where the formulas are derived.
#ifndef CREASE_GLSL
#define CREASE_GLSL

#include "lib/bspline.glsl"

vec4 infinitely_sharp(vec4 b) {
    precise vec4 sharp = vec4(0.0, b.y + 2.0 * b.x, b.z - b.x, b.w);
    return sharp;
}

vec4 after_refinement(vec4 b, float a) {
    precise float e = a * a * a;
    precise vec4 smooth_again = vec4(b.x * a, b.x * (1.0 - a) + b.y + b.z * (1.0 - a) + b.w * (1.0 - 2.0 * a + e),
                                     b.z * a + b.w * 2.0 * (a - e), b.w * e);
    return smooth_again;
}

// The first `level` refinements are sharp, all others smooth.
Basis after_sharp_levels(float t, int level) {
    float scale = power_of_two(level);
    precise float grown = t * scale;
    if (grown >= 1.0) {
        Basis basis = bspline_basis(t);
        return Basis(infinitely_sharp(basis.value), infinitely_sharp(basis.derivative));
    }
    Basis basis = bspline_basis(grown);
    precise float a = 1.0 / scale;
    precise vec4 derivative = after_refinement(basis.derivative, a) * scale;
    return Basis(after_refinement(basis.value, a), derivative);
}

Basis crease_basis(float t, float sharpness) {
    float level = floor(sharpness);
    precise float fraction = sharpness - level;
    Basis lower = after_sharp_levels(t, int(level));
    Basis upper = after_sharp_levels(t, int(level) + 1);
    precise vec4 value = lower.value + fraction * (upper.value - lower.value);
    precise vec4 derivative = lower.derivative + fraction * (upper.derivative - lower.derivative);
    return Basis(value, derivative);
}

Basis reversed(Basis basis) { return Basis(basis.value.wzyx, -basis.derivative.wzyx); }

// The bases of both directions, with a crease along edge `edge` (v = 0, u = 1, v = 1, u = 0).
void creased_bases(vec2 uv, uint edge, float sharpness, out Basis u, out Basis v) {
    u = bspline_basis(uv.x);
    v = bspline_basis(uv.y);
    if (sharpness > 0.0) {
        bool across_v = (edge & 1u) == 0u;
        bool far = edge == 1u || edge == 2u;
        float t = across_v ? uv.y : uv.x;
        precise float other = 1.0 - t;
        Basis basis = crease_basis(far ? other : t, sharpness);
        if (far) basis = reversed(basis);
        if (across_v) v = basis; else u = basis;
    }
}

#endif
