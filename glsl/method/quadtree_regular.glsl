// Regular faces of the quadtree method: plain bicubic B-splines of sixteen control points (Brainerd et al. 2016, section 7.1).
// Twin of `method/quadtree/twin.rs`.
#ifndef QUADTREE_REGULAR_GLSL
#define QUADTREE_REGULAR_GLSL

#define COUNTED_EDGES

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
#define REGULAR_POINT(i) in_point[i]
#define REGULAR_PICK(turned, i, j) (turned ? in_point[j] : in_point[i])
#include "lib/regular.glsl"

bool has_one_normal(Patch record, vec2 uv) { return true; }

Point evaluate_patch(Patch record, uint slot, vec2 uv) { return surface_point(regular_surface(record, uv)); }
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, uv, 1.0); }
#endif

#endif
