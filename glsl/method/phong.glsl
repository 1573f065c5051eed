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

// The derivative of the point by a change of the weights.
vec3 bent_tangent(vec3 weights, vec3 change, vec3 flat_point) {
    vec3 flat_tangent = sum_of_three(change, in_point[0], in_point[1], in_point[2]);
    vec3 planes = sum_of_three(weights, on_plane(flat_tangent, 0u), on_plane(flat_tangent, 1u), on_plane(flat_tangent, 2u));
    vec3 moved = sum_of_three(change, projected(flat_point, 0u), projected(flat_point, 1u), projected(flat_point, 2u));
    precise vec3 sum = planes + moved;
    return towards(flat_tangent, sum);
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec3 weights = corner_weights(uv);
    vec3 flat_point = sum_of_three(weights, in_point[0], in_point[1], in_point[2]);
    if (TANGENTS) {
        keep_tangents(bent_tangent(weights, vec3(-1.0, 1.0, 0.0), flat_point), bent_tangent(weights, vec3(-1.0, 0.0, 1.0), flat_point));
    }
    vec3 bent = sum_of_three(weights, projected(flat_point, 0u), projected(flat_point, 1u), projected(flat_point, 2u));
    return Point(towards(flat_point, bent), unit(sum_of_three(weights, in_point[3], in_point[4], in_point[5])));
}
#endif

#endif
