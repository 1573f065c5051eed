// Phong tessellation (Boubekeur, Alexa 2008). Twin of `method/phong.rs`.
#ifndef PHONG_GLSL
#define PHONG_GLSL

#define TRIANGLES

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"
#include "lib/surface.glsl"
#include "lib/triangle.glsl"

const uint CONTROL_POINTS = 1u;
#define CONTROL_VERTICES 6

#ifdef STAGE_CONTROL
// Three positions, three normals.
vec3 patch_point(Patch record, uint number) {
    Point corner = patch_control(record, number % 3u);
    return number < 3u ? corner.position : corner.normal;
}
#endif

#ifdef STAGE_EVALUATION
#define NORMALS 3u
#include "lib/phong.glsl"

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec3 weights = corner_weights(uv);
    vec3 flat_point = sum_of_three(weights, in_point[0], in_point[1], in_point[2]);
    vec3 bent = sum_of_three(weights, projected(flat_point, 0u), projected(flat_point, 1u), projected(flat_point, 2u));
    return Point(towards(flat_point, bent), unit(sum_of_three(weights, in_point[3], in_point[4], in_point[5])));
}
#endif

#endif
