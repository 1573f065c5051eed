// A point of a surface. Twin of `method::Surface`.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

struct Surface {
    vec3 position;
    vec3 du;
    vec3 dv;
};

// Unit length, or zero where there is no direction.
vec3 normalize_or_zero(vec3 v) {
    float length_squared = dot(v, v);
    return length_squared > 0.0 ? v * inversesqrt(length_squared) : vec3(0.0);
}

// The tangents are scaled first: far down a quadtree their product would leave the range of floats.
vec3 surface_normal(Surface surface) {
    return normalize_or_zero(cross(normalize_or_zero(surface.du), normalize_or_zero(surface.dv)));
}

#endif
