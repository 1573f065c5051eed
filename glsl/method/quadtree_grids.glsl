// Rectangles of regular faces as one patch, which share a grid of control vertices (Brainerd et al. 2016, section 7.3, figure 7).
// Twin of `method/quadtree/macro_faces.rs`.
#ifndef QUADTREE_GRIDS_GLSL
#define QUADTREE_GRIDS_GLSL

#define MACRO_FACES
#define FETCHED_GRID

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/control_vertex.glsl"
#include "lib/levels.glsl"

// The evaluation shader fetches vertices itself.
const uint CONTROL_POINTS = 1u;
#define CONTROL_VERTICES 1

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) { return vec3(0.0); }
#endif

#ifdef STAGE_CONTROL
vec3 patch_point(Patch record, uint number) { return vec3(0.0); }
#endif

#include "lib/macro_plain.glsl"

#endif
