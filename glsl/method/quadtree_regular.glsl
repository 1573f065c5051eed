// Regular faces of the quadtree method: plain bicubic B-splines of sixteen control points (Brainerd et al. 2016, section 7.1).
// Twin of `method/quadtree.rs`.
#ifndef QUADTREE_REGULAR_GLSL
#define QUADTREE_REGULAR_GLSL

#include "lib/bspline.glsl"
#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/control_vertex.glsl"
#include "lib/levels.glsl"

const uint CONTROL_POINTS = 16u;
#define CONTROL_VERTICES 16

uint greatest_level(Patch record) { return HIGHEST_LEVEL; }

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) { return control_vertex(controls[record.controls + number]); }
#endif

#ifdef STAGE_EVALUATION
Surface evaluate_patch(Patch record, uint slot, vec2 uv) {
    Basis u = bspline_basis(uv.x);
    Basis v = bspline_basis(uv.y);
    Surface surface = Surface(vec3(0.0), vec3(0.0), vec3(0.0));
    // Written out: control points that are read by constant index stay in registers.
    add_row(surface, u, v.value.x, v.derivative.x, in_point[0], in_point[1], in_point[2], in_point[3]);
    add_row(surface, u, v.value.y, v.derivative.y, in_point[4], in_point[5], in_point[6], in_point[7]);
    add_row(surface, u, v.value.z, v.derivative.z, in_point[8], in_point[9], in_point[10], in_point[11]);
    add_row(surface, u, v.value.w, v.derivative.w, in_point[12], in_point[13], in_point[14], in_point[15]);
    return surface;
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, uv, 1.0); }
#endif

#endif
