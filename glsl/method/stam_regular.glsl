// Regular faces of the method stam: bicubic B-splines of sixteen points. Twin of `method/stam.rs`.
#ifndef STAM_REGULAR_GLSL
#define STAM_REGULAR_GLSL

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"
#include "lib/points.glsl"

const uint CONTROL_POINTS = 1u;
#define CONTROL_VERTICES 16

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) { return vec3(0.0); }
#endif

#ifdef STAGE_CONTROL
vec3 patch_point(Patch record, uint number) { return patch_control(record, number).position; }
#endif

#ifdef STAGE_EVALUATION
#define REGULAR_POINT(i) in_point[i]
#define REGULAR_PICK(turned, i, j) (turned ? in_point[j] : in_point[i])
#include "lib/regular.glsl"

// What is shared has the same normal on all sides.
bool has_one_normal(Patch record, vec2 uv) { return true; }

Point evaluate_patch(Patch record, uint slot, vec2 uv) { return surface_point(regular_surface(record, uv)); }
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, uv, 1.0); }
#endif

#endif
