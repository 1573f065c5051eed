// A point of a surface. Twin of `method::Surface`.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

struct Surface {
    vec3 position;
    vec3 du;
    vec3 dv;
};

// Unit length, or zero where there is no direction. Scaled first, so that no square leaves the range of floats.
vec3 normalize_or_zero(vec3 v) {
    float greatest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if (greatest == 0.0) return vec3(0.0);
    v /= greatest;
    return v * inversesqrt(dot(v, v));
}

// The tangents are made unit vectors first: far down a quadtree, and in tiny or enormous models, their product would leave that range.
vec3 surface_normal(Surface surface) {
    return normalize_or_zero(cross(normalize_or_zero(surface.du), normalize_or_zero(surface.dv)));
}

#endif
