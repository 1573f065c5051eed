// Light and colours of the built-in pictures.
#ifndef SHADING_GLSL
#define SHADING_GLSL

#include "abi.glsl"

// A warm key light from above the eye's left, a cool fill from the right, sky from above; `gloss` is the strength of the highlight.
vec3 lit(vec3 colour, vec3 normal, vec3 to_eye, float gloss) {
    vec3 right = normalize(cross(vec3(0.0, 1.0, 0.0), to_eye) + vec3(1e-6, 0.0, 0.0));
    vec3 up = cross(to_eye, right);
    vec3 key = normalize(to_eye * 0.7 - right * 0.6 + up * 0.75);
    vec3 fill = normalize(to_eye * 0.5 + right * 0.9 - up * 0.1);
    vec3 sky = mix(vec3(0.16, 0.15, 0.15), vec3(0.36, 0.40, 0.46), 0.5 + 0.5 * normal.y);
    vec3 light = sky + vec3(0.95, 0.90, 0.82) * max(dot(normal, key), 0.0) + vec3(0.16, 0.20, 0.28) * max(dot(normal, fill), 0.0);
    float highlight = pow(max(dot(normal, normalize(key + to_eye)), 0.0), 48.0);
    float rim = pow(1.0 - max(dot(normal, to_eye), 0.0), 4.0);
    return colour * light + gloss * (0.22 * highlight + 0.10 * rim) * vec3(1.0, 0.98, 0.95);
}

// A pleasant colour a number, by the golden angle around the hue circle.
vec3 patch_colour(uint number) {
    float hue = fract(float(number) * 0.61803398875) * 6.2831853;
    return 0.55 + 0.3 * cos(hue + vec3(0.0, 2.0944, 4.1888));
}

// The node kinds of a quadtree, in the manner of the figures of Brainerd et al. 2016.
vec3 kind_colour(uint kind) {
    switch (kind) {
    case NODE_REGULAR: return vec3(0.75, 0.75, 0.72);
    case NODE_BOUNDARY: return vec3(0.30, 0.65, 0.45);
    case NODE_CREASE: return vec3(0.90, 0.62, 0.15);
    case NODE_TERMINAL: return vec3(0.25, 0.45, 0.85);
    case NODE_EXTRAORDINARY: return vec3(0.85, 0.20, 0.25);
    default: return vec3(1.0, 0.0, 1.0);
    }
}

#endif
