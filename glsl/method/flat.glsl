// Bilinear patches. Twin of `method/flat.rs`.
#ifndef FLAT_GLSL
#define FLAT_GLSL

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/control_vertex.glsl"
#include "lib/flat.glsl"
#include "lib/levels.glsl"

const uint CONTROL_POINTS = 4u;
#define CONTROL_VERTICES 4

#ifdef STAGE_VERTEX
// Point i is the mean of some control vertices; two words tell where each point's begin and end.
vec3 control_point(Patch record, uint number) {
    uint start = control_at(record.controls + 2u * number);
    uint end = control_at(record.controls + 2u * number + 1u);
    vec3 sum = vec3(0.0);
    for (uint i = start; i < end; ++i) sum += control_vertex(control_at(i));
    return sum / float(end - start);
}
#endif

#ifdef STAGE_CONTROL
vec3 patch_point(Patch record, uint number) { return in_point[number]; }
#endif

#ifdef STAGE_EVALUATION
// Neighbours have normals of their own.
bool has_one_normal(Patch record, vec2 uv) { return all(greaterThan(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0))); }

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec3 bottom = in_point[0] * (1.0 - uv.x) + in_point[1] * uv.x;
    vec3 top = in_point[3] * (1.0 - uv.x) + in_point[2] * uv.x;
    vec3 along = (in_point[1] - in_point[0]) * (1.0 - uv.y) + (in_point[2] - in_point[3]) * uv.y;
    keep_tangents(along, top - bottom);
    float greatest = max(max(reach(in_point[0]), reach(in_point[1])), max(reach(in_point[2]), reach(in_point[3])));
    vec3 normal = flat_normal(along, top - bottom, greatest);
    // Where the corner is straight, or two corners are one: of the diagonals, that is of the whole.
    if (normal == vec3(0.0)) normal = flat_normal(in_point[2] - in_point[0], in_point[3] - in_point[1], greatest);
    return Point(bottom * (1.0 - uv.y) + top * uv.y, normal);
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, uv, 1.0); }
#endif

#endif
