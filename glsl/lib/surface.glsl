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

#ifdef STAGE_EVALUATION
// Whether a fragment shader asks for tangents: a constant of the pipeline, so that who does not ask runs no code for them. Geometry shaders have no components to
// spare for them, and those that have are modules of their own.
#ifndef STAGE_GEOMETRY
layout(constant_id = CONSTANT_ID_TANGENTS) const bool TANGENTS = false;
#elif defined(WITH_TANGENTS)
const bool TANGENTS = true;
#else
const bool TANGENTS = false;
#endif

// The derivatives by the patch's u and v of the point that was evaluated last, for `lib/vertex.glsl`; nothing else reads them.
vec3 kept_du = vec3(0.0);
vec3 kept_dv = vec3(0.0);
// The level that the patch's control points are there for, where tangents are asked for.
uint tangent_level = 0u;

void keep_tangents(vec3 du, vec3 dv) {
    if (!TANGENTS) return;
    kept_du = du;
    kept_dv = dv;
}
#endif

// The point with the normal that its tangents give.
Point surface_point(Surface surface) {
#ifdef STAGE_EVALUATION
    keep_tangents(surface.du, surface.dv);
#endif
    return Point(surface.position, surface_normal(surface));
}

#endif
