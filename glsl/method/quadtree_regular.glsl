// Regular faces of the quadtree method: plain bicubic B-splines of sixteen control points (Brainerd et al. 2016, section 7.1).
// Twin of `method/quadtree/twin.rs`.
#ifndef QUADTREE_REGULAR_GLSL
#define QUADTREE_REGULAR_GLSL

#include "lib/border.glsl"
#include "lib/bspline.glsl"
#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/control_vertex.glsl"
#include "lib/levels.glsl"

const uint CONTROL_POINTS = 16u;
#define CONTROL_VERTICES 16

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) { return control_vertex(control_at(record.controls + number)); }
#endif

#ifdef STAGE_CONTROL
vec3 patch_point(Patch record, uint number) { return in_point[number]; }
#endif

#ifdef STAGE_EVALUATION
bool has_one_normal(Patch record, vec2 uv) { return true; }

// On edges the sums go along the edge first, at corners along the direction that the vertex prefers: so all faces there get the same bits.
Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    uint place = find_place(record.flags, uv).number;
    bool turned = place >= 5u ? (record.flags & (PATCH_TURNED_CORNER << (place - 5u))) != 0u : place == 2u || place == 4u;
    vec2 t = turned_round(turned ? uv.y : uv.x, false);
    vec2 across = turned_round(turned ? uv.x : uv.y, false);
    Basis u = bspline_basis_of(t.x, t.y);
    Basis v = bspline_basis_of(across.x, across.y);
#define PICK(i, j) (turned ? in_point[j] : in_point[i])
    Surface surface = bspline_surface(v, 1.0,
        bspline_row(u, in_point[0], PICK(1, 4), PICK(2, 8), PICK(3, 12)),
        bspline_row(u, PICK(4, 1), in_point[5], PICK(6, 9), PICK(7, 13)),
        bspline_row(u, PICK(8, 2), PICK(9, 6), in_point[10], PICK(11, 14)),
        bspline_row(u, PICK(12, 3), PICK(13, 7), PICK(14, 11), in_point[15]));
#undef PICK
    return surface_point(turned ? Surface(surface.position, surface.dv, surface.du) : surface);
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, uv, 1.0); }
#endif

#endif
