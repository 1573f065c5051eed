// Which patches are not drawn, before anything of them is computed. Twin of `frame/culling.rs`, which tells why.
#ifndef CULLING_GLSL
#define CULLING_GLSL

#include "lib/cells.glsl"
#include "lib/deciding.glsl"

// The share of a limit that vertices have which are not the face's own.
const float FOREIGN = 0.35;
// A thousandth of the picture, on either side.
const float BESIDE = 0.002;
const float ROUNDING = 1e-6;
const float EDGEWISE = 0.02;
// Pixels.
const float BETWEEN = 1.0 / 16.0;

// What bounds a patch.
struct Hull {
    // Where the numbers of its control vertices stand, among the words.
    uint first;
    uint count;
    // How many of them, the first, are its faces' own; 0 where its sides tell.
    uint own;
};

Hull hull_of(Patch record, PatchSides sides) {
    uint rest = sides.hull & ~(HULL_SPLINE | HULL_DYNAMIC | HULL_SHALLOW | HULL_LISTED);
    if ((sides.hull & HULL_LISTED) == 0u) return Hull(bases.controls + record.controls, rest, 0u);
    uint place = side_list(rest);
    return Hull(place + 2u, words[place + 1u], words[place]);
}

// Vertex i of it.
vec3 hull_point(Hull hull, uint i) { return positions[words[hull.first + i]]; }

// How far within a plane a point may be, in the plane's own units.
float inside_of(vec4 plane, vec4 depth, float reach, vec3 point) {
    vec3 summands = abs(plane.xyz * point);
    float rounding = ROUNDING * (summands.x + summands.y + summands.z + abs(plane.w));
    return before(plane, point) + reach + rounding + BESIDE * abs(before(depth, point));
}

// The greatest of these of a patch's own vertices: those of the edges, or faces, that its edges belong to; of a macro face those of its faces.
float own_inside(PatchSides sides, Hull hull, vec4 plane, vec4 depth, float reach) {
    float greatest = -3.4e38;
    for (uint i = 0u; i < hull.own; ++i) greatest = max(greatest, inside_of(plane, depth, reach, hull_point(hull, i)));
    for (uint side = 0u; side < (hull.own > 0u ? 0u : 4u); ++side) {
        uint place = side_list(sides.sides[side]);
        uint count = words[place];
        for (uint i = 1u; i <= count; ++i) {
            greatest = max(greatest, inside_of(plane, depth, reach, positions[words[place + i]]));
        }
    }
    return greatest;
}

// A side of the picture, whose inside is in front of it: w + x, w - x, w + y, w - y, z, w - z.
vec4 side_of(mat4 clip, uint side) {
    vec4 depth = row_of(clip, 3u);
    vec4 across = row_of(clip, side >> 1u);
    return side == 4u ? across : (side & 1u) == 0u ? depth + across : depth - across;
}

// Whether a patch is outside of one side of the picture.
bool is_outside(PatchSides sides, Hull hull, uint seen) {
    mat4 clip = views[seen].clip_from_model;
    vec4 depth = row_of(clip, 3u);
    float height = abs(views[seen].displacement.x);
    for (uint side = 0u; side < 6u; ++side) {
        vec4 plane = side_of(clip, side);
        float reach = height * sqrt(squared(plane.xyz));
        float own = own_inside(sides, hull, plane, depth, reach);
        uint count = own < 0.0 ? hull.count : 0u;
        float all = own;
        for (uint i = 0u; i < count; ++i) all = max(all, inside_of(plane, depth, reach, hull_point(hull, i)));
        if (own < 0.0 && own + FOREIGN * (all - own) < 0.0) return true;
    }
    return false;
}

// Whether no sample is in the box around the picture of a patch.
bool is_small(Hull hull, uint seen) {
    float rows = float(decision.flags >> DECIDE_ROWS_SHIFT & 15u);
    mat4 clip = views[seen].clip_from_model;
    vec4 depth = row_of(clip, 3u);
    float height = abs(views[seen].displacement.x);
    float away = height * sqrt(squared(depth.xyz));
    for (uint axis = 0u; axis < 2u; ++axis) {
        vec4 row = row_of(clip, axis);
        float reach = height * sqrt(squared(row.xyz));
        float low = 3.4e38;
        float high = -3.4e38;
        bool before_eye = true;
        for (uint i = 0u; i < hull.count; ++i) {
            vec3 point = hull_point(hull, i);
            float at = before(row, point);
            float w = before(depth, point);
            // What is no number is nowhere.
            before_eye = before_eye && w - away > 1e-3 * abs(w) && abs(at) < 3.4e38 && abs(w) < 3.4e38;
            low = min(low, (at - reach) / (at < reach ? w - away : w + away));
            high = max(high, (at + reach) / (at > -reach ? w - away : w + away));
        }
        if (!before_eye) return false;
        float first = (low * (0.5 * decision.size[axis]) + 0.5 * decision.size[axis] - BETWEEN) * rows - 0.5;
        float last = (high * (0.5 * decision.size[axis]) + 0.5 * decision.size[axis] + BETWEEN) * rows - 0.5;
        // In floats that tell pixels apart.
        if (last - first < 1.0 && abs(first) < 65536.0 * rows && floor(first) == floor(last)) return true;
    }
    return false;
}

// The axis of the cone around vectors and all that is within `slant` of their hull, and the sine of the angle to its side; more than 1 where it is no cone.
vec4 cone(vec3 vectors[12], float slant) {
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < 12u; ++i) sum += vectors[i];
    vec3 axis = sum / sqrt(squared(sum));
    float tangent = 0.0;
    bool is_cone = true;
    for (uint i = 0u; i < 12u; ++i) {
        float along = dot(axis, vectors[i]);
        float across = sqrt(squared(vectors[i] - along * axis)) + slant;
        // Not what is no number.
        is_cone = is_cone && along - slant > 0.0;
        tangent = max(tangent, across / (along - slant));
    }
    return vec4(axis, is_cone ? tangent / sqrt(1.0 + tangent * tangent) : 2.0);
}

// A row over the greatest of its numbers.
vec4 scaled_row(vec4 row) { return row / max(max(abs(row.x), abs(row.y)), max(abs(row.z), abs(row.w))); }

// Where everything is seen from, homogeneous.
vec4 eye_of(mat4 clip) {
    vec4 a = scaled_row(row_of(clip, 0u));
    vec4 b = scaled_row(row_of(clip, 1u));
    vec4 c = scaled_row(row_of(clip, 3u));
    vec3 bc = cross(b.xyz, c.xyz);
    vec3 eye = -(a.w * bc + b.w * cross(c.xyz, a.xyz) + c.w * cross(a.xyz, b.xyz));
    return vec4(eye, dot(a.xyz, bc));
}

// The lengths of the second differences of control points: the greatest along u twice, along both, along v twice.
vec3 second_differences(vec3 points[16]) {
    vec3 greatest = vec3(0.0);
    for (uint i = 0u; i < 8u; ++i) {
        uint row = 4u * (i >> 1u) + (i & 1u);
        uint column = (i >> 1u) + 4u * (i & 1u);
        vec3 along_u = (points[row] - points[row + 1u]) - (points[row + 1u] - points[row + 2u]);
        vec3 along_v = (points[column] - points[column + 4u]) - (points[column + 4u] - points[column + 8u]);
        greatest.x = max(greatest.x, squared(along_u));
        greatest.z = max(greatest.z, squared(along_v));
    }
    for (uint i = 0u; i < 9u; ++i) {
        uint at = i % 3u + 4u * (i / 3u);
        vec3 both = (points[at + 5u] - points[at + 4u]) - (points[at + 1u] - points[at]);
        greatest.y = max(greatest.y, squared(both));
    }
    return sqrt(greatest);
}

// The Bezier points of a bicubic B-spline patch.
void make_bezier(inout vec3 points[16]) {
    for (uint i = 0u; i < 8u; ++i) {
        uint step = i < 4u ? 1u : 4u;
        uint first = i < 4u ? 4u * i : i - 4u;
        vec3 a = points[first];
        vec3 b = points[first + step];
        vec3 c = points[first + 2u * step];
        vec3 d = points[first + 3u * step];
        points[first] = ((a + c) + 4.0 * b) / 6.0;
        points[first + step] = (2.0 * b + c) / 3.0;
        points[first + 2u * step] = (b + 2.0 * c) / 3.0;
        points[first + 3u * step] = ((b + d) + 4.0 * c) / 6.0;
    }
}

// Whether all triangles of a bicubic B-spline patch with these levels show their backs.
bool is_spline_back(vec3 points[16], uint seen, vec4 edges, float inside) {
    make_bezier(points);
    vec2 slants = vec2(0.0);
    if (edges != vec4(inside)) {
        if ((decision.flags & FRAME_FRACTIONAL_EVEN) != 0u) return false;
        float least = ceil(min(min(edges.x, edges.y), min(edges.z, edges.w)));
        float slant = 1.0 + ceil(inside) / least;
        vec3 second = second_differences(points);
        slants = slant * (4.0 / least * second.xz + 3.0 * second.y / ceil(inside));
    }
    vec3 along_u[12];
    vec3 along_v[12];
    for (uint i = 0u; i < 12u; ++i) {
        uint u = i % 3u + 4u * (i / 3u);
        uint v = i / 3u + 4u * (i % 3u);
        along_u[i] = points[u + 1u] - points[u];
        along_v[i] = points[v + 4u] - points[v];
    }
    vec4 u = cone(along_u, slants.y);
    vec4 v = cone(along_v, slants.x);
    vec3 normal = cross(u.xyz, v.xyz);
    float sine = sqrt(squared(normal));
    float spread = sqrt(u.w * u.w + 2.0 * u.w * v.w * abs(dot(u.xyz, v.xyz)) + v.w * v.w) / sine + EDGEWISE;
    if (!(spread < 1.0)) return false;
    vec4 eye = eye_of(views[seen].clip_from_model);
    bool back = true;
    for (uint i = 0u; i < 16u; ++i) {
        vec3 to_eye = eye.xyz - eye.w * points[i];
        // What is no number is not below either.
        back = back && dot(normal, to_eye) < -spread * sine * sqrt(squared(to_eye));
    }
    return back;
}

// Whether each triangle of a macro face with these levels is within one of its cells.
bool are_within_cells(uvec2 cells, vec4 edges, float inside) {
    return edges == vec4(inside) && (inside >= 2.0 || all(greaterThan(cells, uvec2(1u))));
}

// Whether all of a patch that is made of bicubic B-splines shows its back: of a macro face all cells, whose control vertices stand behind its header in a grid.
bool is_back(Patch record, uint seen, vec4 edges, float inside) {
    if (views[seen].displacement.x != 0.0) return false;
    bool many = (record.flags & PATCH_MACRO) != 0u;
    uvec2 cells = many ? cells_of(record) : uvec2(1u);
    uint grid = bases.controls + record.controls + (many ? MACRO_HEADER : 0u);
    bool back = !many || are_within_cells(cells, edges, inside);
    for (uint cell = 0u; cell < cells.x * cells.y && back; ++cell) {
        uint first = grid + cell % cells.x + (cells.x + 3u) * (cell / cells.x);
        vec3 points[16];
        for (uint i = 0u; i < 16u; ++i) points[i] = positions[words[first + (i & 3u) + (cells.x + 3u) * (i >> 2u)]];
        back = is_spline_back(points, seen, edges, inside);
    }
    return back;
}

#endif
