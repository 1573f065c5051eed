// Four regular faces around a vertex as one patch of 25 control vertices (Brainerd et al. 2016, section 7.3, figure 9).
// Twin of `method/quadtree/macro_faces.rs`.
#ifndef QUADTREE_QUARTETS_GLSL
#define QUADTREE_QUARTETS_GLSL

#define MACRO_FACES

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/control_vertex.glsl"
#include "lib/levels.glsl"

const uint CONTROL_POINTS = 25u;
#define CONTROL_VERTICES 25

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) { return control_vertex(control_at(record.controls + MACRO_HEADER + number)); }
#endif

#ifdef STAGE_CONTROL
vec3 patch_point(Patch record, uint number) { return in_point[number]; }
#endif

#include "lib/macro_plain.glsl"

#endif
