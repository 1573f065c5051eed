// How Phong tessellation bends a face (Boubekeur, Alexa 2008). Who includes it says where the normals of its corners begin: NORMALS. Twin of
// `method/phong.rs`.
#ifndef PHONG_LIB_GLSL
#define PHONG_LIB_GLSL

#include "lib/surface.glsl"

// How far points go to where the tangent planes want them; the paper's.
const float SHARE = 0.75;

// Onto the tangent plane of corner i.
vec3 projected(vec3 flat_point, uint i) {
    precise vec3 offset = flat_point - in_point[i];
    precise vec3 on_plane = flat_point - exact_dot(offset, in_point[NORMALS + i]) * in_point[NORMALS + i];
    return on_plane;
}

// The derivative of a projection by what `flat_point` changes by.
vec3 on_plane(vec3 flat_tangent, uint i) {
    precise vec3 along = flat_tangent - exact_dot(flat_tangent, in_point[NORMALS + i]) * in_point[NORMALS + i];
    return along;
}

vec3 towards(vec3 flat_point, vec3 bent) {
    precise vec3 position = (1.0 - SHARE) * flat_point + SHARE * bent;
    return position;
}

#endif
