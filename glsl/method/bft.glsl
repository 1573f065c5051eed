// Tables of face functions (Holländer, Boubekeur 2011). Twin of `method/bft.rs`.
#ifndef BFT_GLSL
#define BFT_GLSL

#ifdef QUADS
const uint CORNERS = 4u;
#else
#define TRIANGLES
const uint CORNERS = 3u;
#endif

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"
#include "lib/points.glsl"
#include "lib/surface.glsl"

// Nothing goes from stage to stage but the patch's number: the evaluation shader fetches what it sums.
const uint CONTROL_POINTS = 1u;
#define CONTROL_VERTICES 1

// What is shared has the same normal on all sides.
bool has_one_normal(Patch record, vec2 uv) { return true; }

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) { return vec3(0.0); }
#endif

#ifdef STAGE_CONTROL
vec3 patch_point(Patch record, uint number) { return vec3(0.0); }
#endif

#ifdef STAGE_EVALUATION
#include "lib/lattice.glsl"

// The method's own tables, in this order.
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer WeightTable { float weights[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer FaceTable { TableFace faces[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer PlaceTable { TablePlace places[]; };

// A face, whose weights begin where they do in the buffer.
TableFace face_at(uint number) {
    TableFace face = faces[bases.own[1] + number];
    face.weights += bases.own[0];
    return face;
}

// Where a point of the patch lies: a corner, an edge from its first corner on, or with neither the inside.
struct Spot {
    uint corner;
    uint edge;
    float along;
};

const uint NOWHERE = 4u;

Spot spot(vec2 uv) {
#ifdef QUADS
    bool on[4] = bool[](uv.y <= 0.0, uv.x >= 1.0, uv.y >= 1.0, uv.x <= 0.0);
    precise float along[4] = float[](uv.x, uv.y, 1.0 - uv.x, 1.0 - uv.y);
#else
    precise float last = (1.0 - uv.x) - uv.y;
    bool on[3] = bool[](uv.y <= 0.0, last <= 0.0, uv.x <= 0.0);
    precise float along[3] = float[](uv.x, uv.y, 1.0 - uv.y);
#endif
    Spot found = Spot(NOWHERE, NOWHERE, 0.0);
    for (uint edge = CORNERS; edge-- > 0u;) {
        if (!on[edge]) continue;
        found.edge = edge;
        found.along = along[edge];
        if (on[(edge + CORNERS - 1u) % CORNERS]) found.corner = edge;
    }
    return found;
}

// The sum over the face's points (equation 1), from the last to the first; the same weights for normals are subdivision shading (section
// II-C). Normals have any length.
Point weighted(TableFace face, Shares shares) {
    uint rows = row_count(shares);
    precise vec3 position = vec3(0.0);
    precise vec3 normal = vec3(0.0);
    for (uint i = face.count; i-- > 0u;) {
        precise float weight = 0.0;
        for (uint k = 0u; k < rows; ++k) {
            weight += shares.shares[k] * weights[face.weights + shares.rows[k] * face.count + i];
        }
        Point point = points[control_at(face.controls + i)];
        position += weight * point.position;
        normal += weight * point.normal;
    }
    return Point(position, normal);
}

// The normal from tangents (section II-C) at each point of the lattice, linear between. Their weights sum to zero, so they are sums of
// differences, which lose less; zero where rounding may have made them. Each spoke errs by the rounding of both its ends.
vec3 limit_normal(TableFace face, Shares shares) {
    vec3 origin = points[control_at(face.controls)].position;
    uint rows = row_count(shares);
    precise float roundings = float(face.count) + 4.0;
    precise vec3 normal = vec3(0.0);
    for (uint k = 0u; k < rows; ++k) {
        uint first = face.weights + 2u * shares.rows[k] * face.count;
        precise vec3 du = vec3(0.0);
        precise vec3 dv = vec3(0.0);
        precise vec2 spread = vec2(0.0);
        precise vec2 total = vec2(0.0);
        for (uint i = face.count; i-- > 0u;) {
            precise vec3 spoke = points[control_at(face.controls + i)].position - origin;
            vec2 weight = vec2(weights[first + i], weights[first + face.count + i]);
            du += weight.x * spoke;
            dv += weight.y * spoke;
            spread += abs(weight) * reach(spoke);
            total += abs(weight);
        }
        precise vec2 errors = ROUNDING * (roundings * spread + (4.0 * reach(origin)) * total);
        normal += shares.shares[k] * clear_normal(Tangents(du, dv, errors));
    }
    return normal;
}

// A point of a face, whose normal may come from another table.
Point summed(uint number, Shares shares) {
    TableFace face = face_at(number);
    Point point = weighted(face, shares);
    if (face.normals != number) {
        TableFace other = face_at(face.normals & ~TABLE_TANGENTS);
        if ((face.normals & TABLE_TANGENTS) != 0u) point.normal = limit_normal(other, shares);
        else point.normal = weighted(other, shares).normal;
    }
    point.normal = unit(point.normal);
    return point;
}

// The derivatives of what is drawn, linear between points of the face's own lattice.
void keep_lattice_tangents(TableFace face, vec2 uv) {
    Shares shares = lattice_inside(face, uv);
    Changes changes = lattice_changes(face, uv);
    vec3 origin = points[control_at(face.controls)].position;
    precise vec3 du = vec3(0.0);
    precise vec3 dv = vec3(0.0);
    for (uint i = face.count; i-- > 0u;) {
        precise vec2 weight = vec2(0.0);
        for (uint k = 0u; k < 4u; ++k) {
            weight += vec2(changes.by_u[k], changes.by_v[k]) * weights[face.weights + shares.rows[k] * face.count + i];
        }
        precise vec3 spoke = points[control_at(face.controls + i)].position - origin;
        du += weight.x * spoke;
        dv += weight.y * spoke;
    }
    keep_tangents(du, dv);
}

// Which face is asked and for what stands first, and the sum once: code that is there for each case would be run for all of them wherever some
// invocations of a group are at edges and others inside.
Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    Spot found = spot(uv);
    uint first = bases.own[2] + record.plan * 2u * CORNERS;
    uint number = record.plan;
    Shares shares;
    if (found.corner != NOWHERE) {
        TablePlace place = places[first + CORNERS + found.corner];
        number = place.face;
        shares = Shares(uvec4(place.side, 0u, 0u, 0u), vec4(1.0, 0.0, 0.0, 0.0));
    } else if (found.edge != NOWHERE) {
        TablePlace place = places[first + found.edge];
        number = place.face;
        bool flipped = (place.side & PLACE_FLIPPED) != 0u;
        precise float reverse = 1.0 - found.along;
        precise float at = (flipped ? reverse : found.along) * float(face_at(number).segments);
        shares = lattice_along(face_at(number), place.side & ~PLACE_FLIPPED, at);
    } else {
        shares = lattice_inside(face_at(number), uv);
    }
    if (TANGENTS) keep_lattice_tangents(face_at(record.plan), uv);
    return summed(number, shares);
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, uv, 1.0); }
#endif

#endif
