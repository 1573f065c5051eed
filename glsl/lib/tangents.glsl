// Which sums of tangents are directions, and which are rounding. Twin of `Tangents` in `method/surface.rs`.
#ifndef TANGENTS_GLSL
#define TANGENTS_GLSL

#include "lib/unit.glsl"

// A unit of rounding, and how many times its own error a sum has to be to count as a direction.
const float ROUNDING = 5.9604645e-8;
const float CLEAR = 4.0;

// Two tangents, each with a bound on its rounding error.
struct Tangents {
    vec3 du;
    vec3 dv;
    vec2 errors;
};

float reach(vec3 v) { return max(abs(v.x), max(abs(v.y), abs(v.z))); }

// The power of two that brings a vector's greatest element to 2..4, as `scaled` does; 0 where that gives zero.
float factor(vec3 v) {
    uint exponent = floatBitsToUint(reach(v)) & EXPONENT;
    return exponent == 0u || exponent == EXPONENT ? 0.0 : uintBitsToFloat((255u << 23) - exponent);
}

// Whether they span a plane beyond what rounding may have made of them: by additions and multiplications alone, so that all devices agree.
bool span_plane(Tangents tangents) {
    vec3 a = scaled(tangents.du);
    vec3 b = scaled(tangents.dv);
    precise vec2 errors = CLEAR * (vec2(factor(tangents.du), factor(tangents.dv)) * tangents.errors);
    // An element of the product errs by no more than twice each error times the other's greatest element, which is below 4.
    precise float bound = 8.0 * (errors.x + errors.y);
    return errors.x < 2.0 && errors.y < 2.0 && reach(exact_cross(a, b)) > bound;
}

// Where the limit's tangents count only if the surroundings have a normal like theirs: how much they span at least beside the sum of their squares, and
// how far their normal may be from that nearby; squared.
const float FIRM = 0.0009765625;
const float NEAR_SQUARE = 0.0076;

// Whether they span enough beside their squares: not if they are nearly parallel, nor if one is far longer than the other.
bool are_firm(Tangents tangents) {
    float grown = factor(reach(tangents.du) > reach(tangents.dv) ? tangents.du : tangents.dv);
    precise vec3 a = grown * tangents.du;
    precise vec3 b = grown * tangents.dv;
    vec3 area = exact_cross(a, b);
    precise float squares = exact_dot(a, a) + exact_dot(b, b);
    precise float least = FIRM * (squares * squares);
    return squares > 0.0 && exact_dot(area, area) >= least;
}

// Whether a normal and that nearby are so much alike that the former counts.
bool are_near(vec3 own, vec3 nearby) {
    precise vec3 apart = own - nearby;
    return own != vec3(0.0) && exact_dot(apart, apart) < NEAR_SQUARE;
}

// The unit normal; zero where it is left to rounding.
vec3 clear_normal(Tangents tangents) {
    if (!span_plane(tangents)) return vec3(0.0);
    return unit(exact_cross(unit(tangents.du), unit(tangents.dv)));
}

#endif
