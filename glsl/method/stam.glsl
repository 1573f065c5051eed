// Faces at an extraordinary vertex, by the eigenbasis of its subdivision matrix (Stam 1998). Twin of `method/stam.rs`.
#ifndef STAM_GLSL
#define STAM_GLSL

#include "lib/cell.glsl"
#include "lib/control_points.glsl"
#include "lib/levels.glsl"
#include "lib/points.glsl"

// Nothing goes from stage to stage but the patch's number: the evaluation shader fetches what it sums.
const uint CONTROL_POINTS = 1u;
#define CONTROL_VERTICES 1

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) { return vec3(0.0); }
#endif

#ifdef STAGE_CONTROL
vec3 patch_point(Patch record, uint number) { return vec3(0.0); }
#endif

#ifdef STAGE_EVALUATION
vec3 grid_point(Patch record, uint i) { return patch_control(record, EIGEN_GRID + i).position; }

#define REGULAR_POINT(i) grid_point(record, i)
#define REGULAR_PICK(turned, i, j) grid_point(record, turned ? j : i)
#include "lib/regular.glsl"

// The method's own tables, in this order.
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer EigenbasisTable { Eigenbasis eigenbases[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer CoefficientTable { float coefficients[]; };

// What is shared has the same normal on all sides.
bool has_one_normal(Patch record, vec2 uv) { return true; }

// Sum of four products, in the order of `blend`.
float weighted(vec4 w, vec4 p) {
    precise float sum = (w.x * p.x + w.z * p.z) + (w.y * p.y + w.w * p.w);
    return sum;
}

// The sum of eigenvectors (section 4, equation 14), where it is not the limit itself. The first vector is one everywhere: it has no derivatives, and its point is the
// limit.
Surface eigen_surface(Patch record, uint vectors, vec2 uv) {
    // How often the patch is halved: floor(-log2) of the larger coordinate, read off the exponent of the float.
    uint level = (127u - min(floatBitsToUint(max(uv.x, uv.y)) >> 23, 126u)) - 1u;
    level = min(level, EIGEN_LEVELS - 1u);
    float grown = power_of_two(int(level));
    precise vec2 local = grown * uv;
    bvec2 beyond = greaterThanEqual(local, vec2(0.5));
    precise vec2 own = 2.0 * local - vec2(beyond);
    uint piece = max(uint(beyond.x) + 2u * uint(beyond.y), 1u) - 1u;
    Basis u = bspline_basis(own.x);
    Basis v = bspline_basis(own.y);
    Eigenbasis basis = eigenbases[bases.own[0] + record.plan];
    uint first = bases.own[1] + basis.coefficients + 16u * (piece * basis.count);
    uint power = bases.own[1] + basis.powers + level * basis.count;
    precise vec3 position = patch_control(record, EIGEN_LIMIT).position;
    precise vec3 du = vec3(0.0);
    precise vec3 dv = vec3(0.0);
    for (uint i = 1u; i < basis.count; ++i) {
        precise vec4 values;
        precise vec4 slopes;
        for (uint y = 0u; y < 4u; ++y) {
            uint at = first + 16u * i + 4u * y;
            vec4 row = vec4(coefficients[at], coefficients[at + 1u], coefficients[at + 2u], coefficients[at + 3u]);
            values[y] = weighted(u.value, row);
            slopes[y] = weighted(u.derivative, row);
        }
        precise vec3 point = coefficients[power + i] * points[vectors + i].position;
        position += weighted(v.value, values) * point;
        du += weighted(v.value, slopes) * point;
        dv += weighted(v.derivative, values) * point;
    }
    // Each halving doubles derivatives, and the pieces are quarters.
    precise float scale = 2.0 * grown;
    precise vec3 along_u = scale * du;
    precise vec3 along_v = scale * dv;
    return Surface(position, along_u, along_v);
}

// Edges away from the extraordinary vertex are those of B-splines. The others are evaluated by the face that they leave the vertex in: its u is this one's v, and its
// v runs against this one's u.
Surface surface_at(Patch record, vec2 uv) {
    if (uv.x >= 1.0 || uv.y >= 1.0) return regular_surface(record, uv);
    bool next = uv.x <= 0.0 && control_at(record.controls + EIGEN_NEXT) != EIGEN_HOLE;
    uint vectors = control_at(record.controls + (next ? EIGEN_NEXT : EIGEN_VECTORS));
    Surface surface = eigen_surface(record, vectors, next ? uv.yx : uv);
    return next ? Surface(surface.position, -surface.dv, surface.du) : surface;
}

// At an extraordinary vertex derivatives have no limit, or zero, and their directions along the edges have: those of the level's first vertices.
Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    if (uv == vec2(0.0)) {
        if (TANGENTS) {
            float nearest = power_of_two(-int(tangent_level));
            keep_tangents(surface_at(record, vec2(nearest, 0.0)).du, surface_at(record, vec2(0.0, nearest)).dv);
        }
        return patch_control(record, EIGEN_LIMIT);
    }
    return surface_point(surface_at(record, uv));
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_TERMINAL, uv, 1.0); }
#endif

#endif
