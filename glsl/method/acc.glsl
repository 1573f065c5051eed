// Bicubic patches with tangent patches (Loop, Schaefer 2008). Twin of `method/acc.rs`.
#ifndef ACC_GLSL
#define ACC_GLSL

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"

const uint CONTROL_POINTS = 1u;
const uint CORNERS = 4u;
// The points of an edge: next to its beginning, the tangent there, its field, the tangent at its end, and next to that.
const uint PER_EDGE = 8u;
const uint EDGE_NEAR = 0u;
const uint EDGE_FIRST = 1u;
const uint FIELD = 2u;
const uint EDGE_LAST = 6u;
const uint EDGE_FAR = 7u;
// Corners; next to corner i on edge i, and next to corner i + 1; inside; the tangents at the beginning and the end of each edge, and the derivatives across it
// at a third and at two thirds.
#define CONTROL_VERTICES 32
const uint NEAR = 4u;
const uint FAR = 8u;
const uint INNER = 12u;
const uint FIRST = 16u;
const uint LAST = 20u;
const uint THIRDS = 24u;
const uint TWO_THIRDS = 28u;

#include "lib/bicubic.glsl"
#include "lib/edge_field.glsl"

#ifdef STAGE_CONTROL
// The method's own table: of each patch those of its corners.
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer CosineTable { vec4 cosines[]; };

vec3 patch_point(Patch record, uint number) {
    uint i = number & 3u;
    if (number < NEAR) return patch_control(record, i).position;
    if (number >= INNER && number < FIRST) return patch_control(record, CORNERS + CORNERS * PER_EDGE + i).position;
    vec3 near = edge_point(record, i, EDGE_NEAR);
    if (number < FAR) return near;
    vec3 far = edge_point(record, i, EDGE_FAR);
    if (number < INNER) return far;
    float direction = direction_of(record, i);
    precise vec3 first = direction * edge_point(record, i, EDGE_FIRST);
    precise vec3 last = direction * edge_point(record, i, EDGE_LAST);
    if (number < LAST) return first;
    if (number < THIRDS) return last;
    // Half of what both faces' sum is, and the field.
    vec4 all = cosines[bases.own[0] + record.plan];
    float c0 = all[i];
    float c1 = all[(i + 1u) & 3u];
    bool one = number < TWO_THIRDS;
    const float THIRD = 1.0 / 3.0;
    precise vec3 middle = 3.0 * (far - near);
    precise vec3 field = direction * edge_point(record, i, one ? FIELD + 1u : FIELD + 2u);
    precise vec3 at_third = THIRD * ((2.0 * c0) * middle - c1 * first) + field;
    precise vec3 at_two_thirds = THIRD * (c0 * last - (2.0 * c1) * middle) + field;
    return one ? at_third : at_two_thirds;
}
#endif

#ifdef STAGE_EVALUATION
vec3 edge_middle(uint i) {
    precise vec3 middle = 3.0 * (in_point[FAR + i] - in_point[NEAR + i]);
    return middle;
}

vec3 between(uint from, uint to) {
    precise vec3 apart = 3.0 * (in_point[INNER + to] - in_point[INNER + from]);
    return apart;
}

// Both tangent patches: quadratic along, cubic across.
Surface tangent_patches(vec3 position, vec2 uv) {
    precise vec2 rest = 1.0 - uv;
    vec2 in_u = vec2(rest.x, uv.x);
    vec2 in_v = vec2(rest.y, uv.y);
    vec3 du = sum_of_four(cubic_weights(in_v.x, in_v.y), along_quadratic(in_point[FIRST], edge_middle(0u), in_point[LAST], in_u),
                          along_quadratic(in_point[TWO_THIRDS + 3u], between(0u, 1u), -in_point[THIRDS + 1u], in_u),
                          along_quadratic(in_point[THIRDS + 3u], between(3u, 2u), -in_point[TWO_THIRDS + 1u], in_u),
                          along_quadratic(-in_point[LAST + 2u], -edge_middle(2u), -in_point[FIRST + 2u], in_u));
    vec3 dv = sum_of_four(cubic_weights(in_u.x, in_u.y), along_quadratic(-in_point[LAST + 3u], -edge_middle(3u), -in_point[FIRST + 3u], in_v),
                          along_quadratic(in_point[THIRDS], between(0u, 3u), -in_point[TWO_THIRDS + 2u], in_v),
                          along_quadratic(in_point[TWO_THIRDS], between(1u, 2u), -in_point[THIRDS + 2u], in_v),
                          along_quadratic(in_point[FIRST + 1u], edge_middle(1u), in_point[LAST + 1u], in_v));
    return Surface(position, du, dv);
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    vec3 position = bicubic_position(Inner(in_point[INNER], in_point[INNER + 1u], in_point[INNER + 2u], in_point[INNER + 3u]), uv);
    Spot spot = quad_spot(uv);
    Surface surface = Surface(position, vec3(0.0), vec3(0.0));
    // Borders have normals of their own, but no other tangents.
    if (spot.edge >= 4u || TANGENTS) surface = tangent_patches(position, uv);
    keep_tangents(surface.du, surface.dv);
    if (spot.corner < 4u) return Point(position, patch_control(record, spot.corner).normal);
    uint edge = spot.edge;
    if (edge < 4u) {
        return Point(position, normal_on_edge(record, edge, in_point[FIRST + edge], edge_middle(edge), in_point[LAST + edge], spot.along));
    }
    return surface_point(surface);
}
#endif

#endif
