// B-spline patches of feature-adaptive subdivision (Nießner, Loop, Meyer, DeRose 2012). Twin of `method/fas.rs`.
#ifndef FAS_GLSL
#define FAS_GLSL

#include "lib/piece.glsl"
#include "lib/crease.glsl"

// The edge with a crease plus 1, or 0.
uint crease_of(Patch record) { return record.plan >> PIECE_CREASE_SHIFT & 7u; }

#ifdef STAGE_EVALUATION
Surface surface_at(Patch record, vec2 uv) {
    uint crease = crease_of(record);
    // Behind the points stands the sharpness.
    float sharpness = crease > 0u ? uintBitsToFloat(control_at(record.controls + 16u)) : 0.0;
    Basis u, v;
    creased_bases(uv, max(crease, 1u) - 1u, sharpness, u, v);
    return bspline_surface(v, 1.0, bspline_row(u, in_point[0], in_point[1], in_point[2], in_point[3]),
                           bspline_row(u, in_point[4], in_point[5], in_point[6], in_point[7]),
                           bspline_row(u, in_point[8], in_point[9], in_point[10], in_point[11]),
                           bspline_row(u, in_point[12], in_point[13], in_point[14], in_point[15]));
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    Surface surface = surface_at(record, uv);
    Point own = surface_point(surface);
#ifdef NEARBY_NORMALS
    if (is_unsure(record, uv)) own.normal = sure_normal(surface, surface_normal(surface_at(record, nearby(record, uv))));
#endif
    return own;
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return piece_cell(record, crease_of(record) > 0u ? NODE_CREASE : NODE_REGULAR, uv); }
#endif

#endif
