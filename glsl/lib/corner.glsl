// The normals of vertices, as the control shader decides them. Twin of `method/quadtree/corner.rs`.
#ifndef CORNER_GLSL
#define CORNER_GLSL

#include "lib/surface.glsl"

// At the corner of a single face: the least sine between the limit's tangents, and the greatest distance between its normal and that nearby, at
// which the limit counts; squared.
const float FIRM = 0.00390625;
const float NEAR = 0.25;

// The bounds for sums of weights `total` whose products sum to `spread`, over points about `origin`. Compensated, they err by some units of rounding
// of the absolute sum; the points' own positions by one each.
vec2 rounding_errors(vec2 spread, vec2 total, vec3 origin) {
    precise vec2 errors = ROUNDING * (4.0 * spread + reach(origin) * total);
    return errors;
}

// Whether the tangents are far from parallel.
bool are_firm(Tangents tangents) {
    vec3 normal = exact_cross(unit(tangents.du), unit(tangents.dv));
    return exact_dot(normal, normal) >= FIRM;
}

// The limit's normal at the corner of a single face, or that nearby.
vec3 normal_of_single(Tangents tangents, vec3 limit, vec3 nearby) {
    precise vec3 apart = limit - nearby;
    bool firm = are_firm(tangents) && exact_dot(apart, apart) < NEAR;
    return nearby == vec3(0.0) || firm ? limit : nearby;
}

#endif
