// The normal on an edge between two patches, from what belongs to the edge alone. Twin of `method/edge_field.rs`. Who includes it says how many corners a patch
// has (CORNERS), points an edge (PER_EDGE), and with which of these its field begins (FIELD).
#ifndef EDGE_FIELD_GLSL
#define EDGE_FIELD_GLSL

#include "lib/points.glsl"
#include "lib/surface.glsl"

// Point `i` of an edge.
vec3 edge_point(Patch record, uint edge, uint i) { return patch_control(record, CORNERS + PER_EDGE * edge + i).position; }

// 1 where the patch runs along an edge as the edge's points do, -1 where it runs against it.
float direction_of(Patch record, uint edge) {
    uint first = record.controls + CORNERS + PER_EDGE * edge;
    return control_at(first) < control_at(first + PER_EDGE - 1u) ? 1.0 : -1.0;
}

// Both read the same from either end.
vec3 along_quadratic(vec3 a, vec3 b, vec3 c, vec2 along) {
    precise vec3 sum = ((along.x * along.x) * a + (along.y * along.y) * c) + (2.0 * (along.x * along.y)) * b;
    return sum;
}

vec3 along_cubic(vec3 a, vec3 b, vec3 c, vec3 d, vec2 along) {
    precise vec3 sum = (((along.x * along.x) * along.x) * a + ((along.y * along.y) * along.y) * d) +
                       (3.0 * (along.x * along.y)) * (along.x * b + along.y * c);
    return sum;
}

// The normal there, from the three vectors of the edge's tangent.
vec3 normal_on_edge(Patch record, uint edge, vec3 a, vec3 b, vec3 c, vec2 along) {
    vec3 field = along_cubic(edge_point(record, edge, FIELD), edge_point(record, edge, FIELD + 1u), edge_point(record, edge, FIELD + 2u),
                             edge_point(record, edge, FIELD + 3u), along);
    precise vec3 across = direction_of(record, edge) * field;
    return surface_normal(Surface(vec3(0.0), along_quadratic(a, b, c, along), across));
}

#endif
