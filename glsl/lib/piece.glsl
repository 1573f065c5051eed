// Pieces of ptex faces whose control points are computed points. Twin of `method/fas.rs`.
#ifndef PIECE_GLSL
#define PIECE_GLSL

#define PIECES

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"
#include "lib/points.glsl"
#include "lib/surface.glsl"

const uint CONTROL_POINTS = 1u;
#ifndef CONTROL_VERTICES
#define CONTROL_VERTICES 16
#endif

#ifdef STAGE_VERTEX
// The control shader fetches points itself.
vec3 control_point(Patch record, uint number) { return vec3(0.0); }
#endif

// Who sums them itself says so.
#if defined(STAGE_CONTROL) && !defined(SUMS_POINTS)
vec3 patch_point(Patch record, uint number) { return patch_control(record, number).position; }
#endif

#ifdef STAGE_EVALUATION
// Not on sharp features, and not where an end cap meets others.
bool has_one_normal(Patch record, vec2 uv) {
    bvec4 on = bvec4(uv.y <= 0.0, uv.x >= 1.0, uv.y >= 1.0, uv.x <= 0.0);
    if (!any(on)) return true;
    uint corner = on.x && on.w ? 4u : on.x && on.y ? 5u : on.y && on.z ? 6u : on.z && on.w ? 7u : 8u;
    uint edge = on.x ? 0u : on.y ? 1u : on.z ? 2u : 3u;
    return (record.flags & (PATCH_CREASED << (corner < 8u ? corner : edge))) == 0u;
}
#endif

#ifdef STAGE_EVALUATION
// Whether a corner's normal counts only if that nearby is like it.
bool is_unsure(Patch record, vec2 uv) {
    uint corner = uv.y == 0.0 ? (uv.x == 0.0 ? 0u : uv.x == 1.0 ? 1u : 4u) : uv.y == 1.0 ? (uv.x == 1.0 ? 2u : uv.x == 0.0 ? 3u : 4u) : 4u;
    return corner < 4u && (record.flags & (PATCH_NEARBY_CORNER << corner)) != 0u;
}

// At (1/64, 1/64) of the ptex face from a corner.
vec2 nearby(Patch record, vec2 uv) {
    float away = power_of_two(int(record.plan >> PIECE_DEPTH_SHIFT) - 6);
    precise vec2 inside = uv + away * (1.0 - 2.0 * uv);
    return inside;
}

// Or if rounding may have made it.
vec3 sure_normal(Surface own, vec3 beside) {
    if (beside == vec3(0.0)) return surface_normal(own);
    float greatest = 0.0;
    for (uint i = 0u; i < 16u; ++i) greatest = max(greatest, reach(in_point[i]));
    precise vec2 errors = vec2((16.0 * ROUNDING) * greatest);
    return are_near(clear_normal(Tangents(own.du, own.dv, errors)), beside) ? surface_normal(own) : beside;
}
#endif

#ifdef STAGE_FRAGMENT
// How deep the piece lies shows as the scale does.
Cell piece_cell(Patch record, uint kind, vec2 uv) {
    return Cell(kind, uv, float(1u << (record.plan >> PIECE_DEPTH_SHIFT)));
}
#endif

#endif
