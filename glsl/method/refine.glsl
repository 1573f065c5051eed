// Faces of a mesh that is refined everywhere: bilinear. Twin of `method/refine.rs`.
#ifndef REFINE_GLSL
#define REFINE_GLSL

#define CONTROL_VERTICES 8
#define SUMS_POINTS

#include "lib/piece.glsl"
#include "lib/quad.glsl"

#ifdef STAGE_CONTROL
// Four positions, four normals.
vec3 patch_point(Patch record, uint number) {
    Point corner = patch_control(record, number & 3u);
    return number < 4u ? corner.position : corner.normal;
}
#endif

#ifdef STAGE_EVALUATION
Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec4 weights = quad_weights(uv);
    if (TANGENTS) {
        keep_tangents(sum_of_four(weights_by_u(uv), in_point[0], in_point[1], in_point[2], in_point[3]),
                      sum_of_four(weights_by_v(uv), in_point[0], in_point[1], in_point[2], in_point[3]));
    }
    return Point(sum_of_four(weights, in_point[0], in_point[1], in_point[2], in_point[3]),
                 unit(sum_of_four(weights, in_point[4], in_point[5], in_point[6], in_point[7])));
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return piece_cell(record, NODE_REGULAR, uv); }
#endif

#endif
