// A point of a surface. Twin of `method/surface.rs`.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

#include "abi.glsl"
#include "lib/tangents.glsl"
#include "lib/unit.glsl"

// A point with its tangents.
struct Surface {
    vec3 position;
    vec3 du;
    vec3 dv;
};

// Less than this is rounding, in the product of unit vectors each of which is a sum of a patch's points: 2^-20, sixteen units of rounding.
const float PARALLEL = 9.5367432e-7;

// The tangents are made unit vectors first: far down a quadtree, and in tiny or enormous models, their product would leave the range of floats.
// Turning both tangents by the same quarters leaves every bit as it is.
vec3 surface_normal(Surface surface) {
    vec3 normal = exact_cross(unit(surface.du), unit(surface.dv));
    return reach(normal) > PARALLEL ? unit(normal) : vec3(0.0);
}

// The point with the normal that its tangents give.
Point surface_point(Surface surface) { return Point(surface.position, surface_normal(surface)); }

#endif
