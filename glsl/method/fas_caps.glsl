// End caps of feature-adaptive subdivision: bicubic patches. Twin of `method/fas.rs`.
#ifndef FAS_CAPS_GLSL
#define FAS_CAPS_GLSL

#include "lib/piece.glsl"

const uint NEAR = 4u;
const uint FAR = 8u;
const uint INNER = 12u;

#include "lib/bicubic.glsl"

#ifdef STAGE_EVALUATION
Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    Inner inner = Inner(in_point[INNER], in_point[INNER + 1u], in_point[INNER + 2u], in_point[INNER + 3u]);
    Surface surface = bicubic(inner, uv);
    Point own = surface_point(surface);
    bool corner = (uv.x == 0.0 || uv.x == 1.0) && (uv.y == 0.0 || uv.y == 1.0);
    if (is_unsure(record, uv) || (corner && own.normal == vec3(0.0))) own.normal = sure_normal(surface, surface_normal(bicubic(inner, nearby(record, uv))));
    return own;
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return piece_cell(record, NODE_EXTRAORDINARY, uv); }
#endif

#endif
