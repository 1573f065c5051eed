// Plain triangles. Twin of `method/flat.rs`.
#ifndef FLAT_TRIANGLES_GLSL
#define FLAT_TRIANGLES_GLSL

#define TRIANGLES

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/control_vertex.glsl"
#include "lib/flat.glsl"
#include "lib/levels.glsl"

const uint CONTROL_POINTS = 3u;
#define CONTROL_VERTICES 3

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) { return control_vertex(control_at(record.controls + number)); }
#endif

#ifdef STAGE_CONTROL
vec3 patch_point(Patch record, uint number) { return in_point[number]; }
#endif

#ifdef STAGE_EVALUATION
// Neighbours have normals of their own.
bool has_one_normal(Patch record, vec2 uv) { return min(min(uv.x, uv.y), 1.0 - uv.x - uv.y) > 0.0; }

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec3 position = in_point[0] * (1.0 - uv.x - uv.y) + in_point[1] * uv.x + in_point[2] * uv.y;
    keep_tangents(in_point[1] - in_point[0], in_point[2] - in_point[0]);
    float greatest = max(max(reach(in_point[0]), reach(in_point[1])), reach(in_point[2]));
    return Point(position, flat_normal(in_point[1] - in_point[0], in_point[2] - in_point[0], greatest));
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, uv, 1.0); }
#endif

#endif
