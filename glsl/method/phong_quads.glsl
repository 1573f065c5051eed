// Phong tessellation of quads (Boubekeur, Alexa 2008). Twin of `method/phong.rs`.
#ifndef PHONG_QUADS_GLSL
#define PHONG_QUADS_GLSL

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"
#include "lib/quad.glsl"
#include "lib/surface.glsl"

const uint CONTROL_POINTS = 1u;
#define CONTROL_VERTICES 8

#ifdef STAGE_CONTROL
// Four positions, four normals.
vec3 patch_point(Patch record, uint number) {
    Point corner = patch_control(record, number & 3u);
    return number < 4u ? corner.position : corner.normal;
}
#endif

#ifdef STAGE_EVALUATION
#define NORMALS 4u
#include "lib/phong.glsl"

// The derivative of the point by a change of the weights.
vec3 bent_tangent(vec4 weights, vec4 change, vec3 flat_point) {
    vec3 flat_tangent = sum_of_four(change, in_point[0], in_point[1], in_point[2], in_point[3]);
    vec3 planes = sum_of_four(weights, on_plane(flat_tangent, 0u), on_plane(flat_tangent, 1u), on_plane(flat_tangent, 2u), on_plane(flat_tangent, 3u));
    vec3 moved = sum_of_four(change, projected(flat_point, 0u), projected(flat_point, 1u), projected(flat_point, 2u), projected(flat_point, 3u));
    precise vec3 sum = planes + moved;
    return towards(flat_tangent, sum);
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec4 weights = quad_weights(uv);
    vec3 flat_point = sum_of_four(weights, in_point[0], in_point[1], in_point[2], in_point[3]);
    if (TANGENTS) {
        keep_tangents(bent_tangent(weights, weights_by_u(uv), flat_point), bent_tangent(weights, weights_by_v(uv), flat_point));
    }
    vec3 bent = sum_of_four(weights, projected(flat_point, 0u), projected(flat_point, 1u), projected(flat_point, 2u), projected(flat_point, 3u));
    return Point(towards(flat_point, bent), unit(sum_of_four(weights, in_point[4], in_point[5], in_point[6], in_point[7])));
}
#endif

#endif
