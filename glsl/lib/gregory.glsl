// The control points of Gregory patches (Loop, Schaefer, Ni, Castano 2009). Who includes it says how many corners a patch has: CORNERS. Twin of
// `method/gregory.rs`.
#ifndef GREGORY_LIB_GLSL
#define GREGORY_LIB_GLSL

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"

const uint CONTROL_POINTS = 1u;
// The points of an edge: next to its beginning, its field, next to its end.
const uint PER_EDGE = 6u;
const uint FIELD = 1u;
const uint EDGE_NEAR = 0u;
const uint EDGE_FAR = 5u;
// Corners; next to corner i on edge i, and next to corner i + 1; inside of these.
const uint NEAR = CORNERS;
const uint FAR = 2u * CORNERS;
const uint INSIDE_NEAR = 3u * CORNERS;
const uint INSIDE_FAR = 4u * CORNERS;

#include "lib/blended.glsl"
#include "lib/edge_field.glsl"

#ifdef STAGE_CONTROL
#ifdef TRIANGLES
const float ROWS = 4.0;
const float SHARE = 0.25;
#else
const float ROWS = 3.0;
const float SHARE = 1.0 / 3.0;
#endif

// The method's own table: of each patch those of its corners.
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer CosineTable { vec4 cosines[]; };

vec3 patch_point(Patch record, uint number) {
    uint i = number % CORNERS;
    uint j = (i + 1u) % CORNERS;
    if (number < NEAR) return patch_control(record, i).position;
    vec3 near = edge_point(record, i, EDGE_NEAR);
    if (number < FAR) return near;
    vec3 far = edge_point(record, i, EDGE_FAR);
    if (number < INSIDE_NEAR) return far;
    // The point inside of one next to a corner.
    bool at_end = number >= INSIDE_FAR;
    vec3 corner = patch_control(record, at_end ? j : i).position;
    vec3 next = at_end ? far : near;
    vec3 beyond = at_end ? near : far;
    precise vec3 field = direction_of(record, i) * edge_point(record, i, at_end ? FIELD + 2u : FIELD + 1u);
    vec4 all = cosines[bases.own[0] + record.plan];
    float own = all[at_end ? j : i];
    float other = all[at_end ? i : j];
    precise vec3 along = other * corner + ((ROWS - 2.0 * own) - other) * next;
    precise vec3 inner = SHARE * ((along + (2.0 * own) * beyond) + field);
    return inner;
}
#endif

#ifdef STAGE_EVALUATION
// On edges and at corners normals are what all faces have there; `edge` is CORNERS inside. `at` is the edge's beginning or its end where the point is a corner, or CORNERS.
Point on_border(Patch record, Surface surface, uint edge, uint at, vec2 along) {
    keep_tangents(surface.du, surface.dv);
    if (at < CORNERS) return Point(surface.position, patch_control(record, at).normal);
    if (edge >= CORNERS) return surface_point(surface);
    precise vec3 first = in_point[NEAR + edge] - in_point[edge];
    precise vec3 middle = in_point[FAR + edge] - in_point[NEAR + edge];
    precise vec3 last = in_point[(edge + 1u) % CORNERS] - in_point[FAR + edge];
    return Point(surface.position, normal_on_edge(record, edge, first, middle, last, along));
}
#endif

#endif
