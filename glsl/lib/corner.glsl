// The normals of vertices, as the control shader decides them. Twin of `method/quadtree/corner.rs`.
#ifndef CORNER_GLSL
#define CORNER_GLSL

#include "lib/surface.glsl"

// The bounds for sums of weights `total` whose products sum to `spread`, over points about `origin`. Compensated, they err by some units of rounding
// of the absolute sum; the points' own positions by one each.
vec2 rounding_errors(vec2 spread, vec2 total, vec3 origin) {
    precise vec2 errors = ROUNDING * (4.0 * spread + reach(origin) * total);
    return errors;
}

// The limit's normal at the corner of a single face, or that nearby.
vec3 normal_of_single(Tangents tangents, vec3 limit, vec3 nearby) {
    bool firm = are_firm(tangents) && are_near(limit, nearby);
    return nearby == vec3(0.0) || firm ? limit : nearby;
}

#endif
