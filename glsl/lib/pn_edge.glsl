// What PN triangles and PN quads have on their edges (Vlachos, Peters, Boyd, Mitchell 2001). Twin of `method/pn.rs`.
#ifndef PN_EDGE_GLSL
#define PN_EDGE_GLSL

#include "lib/surface.glsl"

const float THIRD = 1.0 / 3.0;

// The control point of the cubic on the edge from corner a to corner b, next to a (section 3.1).
vec3 edge_point(Point a, Point b) {
    precise vec3 along = b.position - a.position;
    precise vec3 point = THIRD * ((2.0 * a.position + b.position) - exact_dot(along, a.normal) * a.normal);
    return point;
}

// The control point of the quadratic between two corners (section 3.3): the mean normal, mirrored at the plane across the edge.
vec3 edge_normal(Point a, Point b) {
    vec3 along = direction(a.position, b.position);
    precise vec3 sum = a.normal + b.normal;
    precise vec3 mirrored = sum - (2.0 * exact_dot(along, sum)) * along;
    return unit(mirrored);
}

#endif
