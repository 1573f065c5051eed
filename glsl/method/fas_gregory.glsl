// End caps of feature-adaptive subdivision: Gregory patches. Twin of `method/fas.rs`.
#ifndef FAS_GREGORY_GLSL
#define FAS_GREGORY_GLSL

#define CONTROL_VERTICES 20

#include "lib/piece.glsl"

const uint NEAR = 4u;
const uint FAR = 8u;
const uint INSIDE_NEAR = 12u;
const uint INSIDE_FAR = 16u;

#include "lib/blended_quad.glsl"

#ifdef STAGE_EVALUATION
Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    Surface surface = blended_quad(uv);
    Point own = surface_point(surface);
    bool corner = (uv.x == 0.0 || uv.x == 1.0) && (uv.y == 0.0 || uv.y == 1.0);
    if (is_unsure(record, uv) || (corner && own.normal == vec3(0.0))) own.normal = sure_normal(surface, surface_normal(blended_quad(nearby(record, uv))));
    return own;
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return piece_cell(record, NODE_EXTRAORDINARY, uv); }
#endif

#endif
