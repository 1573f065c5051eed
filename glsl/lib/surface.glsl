// A point of a surface. Twin of `method/surface.rs`.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

#include "abi.glsl"

// A point with its tangents.
struct Surface {
    vec3 position;
    vec3 du;
    vec3 dv;
};

// Unit length, or zero where there is no direction. Scaled first, so that no square leaves the range of floats.
vec3 normalize_or_zero(vec3 v) {
    float greatest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if (greatest == 0.0) return vec3(0.0);
    precise vec3 scaled = v / greatest;
    precise float square = (scaled.x * scaled.x + scaled.y * scaled.y) + scaled.z * scaled.z;
    precise vec3 unit = scaled * inversesqrt(square);
    return unit;
}

// The same, and no zero is negative.
vec3 direction(vec3 v) {
    vec3 unit = normalize_or_zero(v);
    return mix(unit, vec3(0.0), equal(unit, vec3(0.0)));
}

// a . b, each product and sum by itself.
float exact_dot(vec3 a, vec3 b) {
    precise float sum = (a.x * b.x + a.y * b.y) + a.z * b.z;
    return sum;
}

// The tangents are made unit vectors first: far down a quadtree, and in tiny or enormous models, their product would leave that range.
// Turning both tangents by the same quarters leaves every bit as it is, once no zero is negative.
vec3 surface_normal(Surface surface) {
    vec3 a = normalize_or_zero(surface.du);
    vec3 b = normalize_or_zero(surface.dv);
    precise vec3 normal = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return direction(normal);
}

// The point with the normal that its tangents give.
Point surface_point(Surface surface) { return Point(surface.position, surface_normal(surface)); }

#endif
