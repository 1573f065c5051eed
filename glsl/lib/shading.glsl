// Light and colours of the built-in pictures.
#ifndef SHADING_GLSL
#define SHADING_GLSL

#include "abi.glsl"
#include "lib/unit.glsl"

// Where the lights are: to the picture's right, up, and out of it.
const vec3 KEY = normalize(vec3(-0.65, 0.80, 0.55));
const vec3 BEHIND = normalize(vec3(0.9, 0.35, -0.35));

// The direction of a vector of any size, or zero where it has none. For colours: unlike `unit` it is as the device's square root is.
vec3 direction(vec3 v) {
    vec3 sized = scaled(v);
    return sized * inversesqrt(max(dot(sized, sized), 1.0));
}

float fourth(float x) { return (x * x) * (x * x); }

// A warm key light from above the eye's left, a cool one from behind the right, sky above and ground below; `gloss` is the strength of
// the highlights. Lights stand still in the picture: where its axes point is the view's. Powers are products:
// cheaper than logarithms, and defined however directions were rounded.
vec3 lit(vec3 colour, vec3 normal, vec3 to_eye, vec3 right, vec3 back, float gloss) {
    vec3 up = cross(back, right);
    vec3 key = KEY.x * right + KEY.y * up + KEY.z * back;
    vec3 behind = BEHIND.x * right + BEHIND.y * up + BEHIND.z * back;
    vec3 ambient = mix(vec3(0.10, 0.09, 0.085), vec3(0.26, 0.30, 0.36), 0.5 + 0.5 * normal.y);
    float key_light = max(dot(normal, key), 0.0);
    float behind_light = max(dot(normal, behind), 0.0);
    vec3 light = ambient + vec3(1.05, 0.98, 0.88) * key_light + vec3(0.20, 0.28, 0.42) * behind_light;
    float mirrored = fourth(clamp(dot(normal, direction(key + to_eye)), 0.0, 1.0));
    float twentieth = mirrored * fourth(mirrored);
    float highlight = twentieth * twentieth * twentieth;
    float slant = 1.0 - clamp(dot(normal, to_eye), 0.0, 1.0);
    float grazing = slant * fourth(slant);
    return colour * light + gloss * (0.25 * highlight * vec3(1.0, 0.97, 0.92) + grazing * 0.12 * vec3(0.8, 0.9, 1.0));
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
