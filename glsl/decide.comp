#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// What is drawn of each patch in each view: its levels, or nothing of it. An invocation a patch and view. Twin of `frame/decision.rs`.
//
// A level depends on the edge alone, whose ends are the same numbers in the same order for both patches there: so both have the same bits.

#include "abi.glsl"
#include "lib/half_level.glsl"

layout(local_size_x = DECIDE_INVOCATIONS) in;

layout(push_constant, scalar) uniform DecisionBlock { Decision decision; };

layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer PatchTable { Patch patches[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer WordTable { uint words[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer SideTable { PatchSides patch_sides[]; };
layout(set = SET_TABLES, binding = BINDING_BASES, scalar) uniform BaseBlock { Bases bases; };
layout(set = SET_POSE, binding = BINDING_POSITIONS, scalar) readonly buffer PositionTable { vec3 positions[]; };
layout(set = SET_FRAME, binding = BINDING_DRAWS, scalar) buffer DrawTable { PatchDraw draws[]; };
layout(set = SET_FRAME, binding = BINDING_VIEWS, scalar) readonly buffer ViewTable { View views[]; };

// A row of a matrix.
vec4 row_of(mat4 matrix, uint row) { return vec4(matrix[0][row], matrix[1][row], matrix[2][row], matrix[3][row]); }

// How far in front of a plane a point is, in the plane's own units.
float before(vec4 plane, vec3 point) {
    precise float distance = ((plane.x * point.x + plane.y * point.y) + plane.z * point.z) + plane.w;
    return distance;
}

float squared(vec3 v) {
    precise float sum = (v.x * v.x + v.y * v.y) + v.z * v.z;
    return sum;
}

// The level that an edge of the mesh is to have, seen from one view.
float level_of_ends(uint seen, vec3 a, vec3 b) {
    if ((decision.flags & DECIDE_SCREEN) != 0u) {
        mat4 clip = views[seen].clip_from_model;
        vec4 depth = row_of(clip, 3u);
        precise float right = 0.5 * decision.size.x * sqrt(squared(row_of(clip, 0u).xyz));
        precise float down = 0.5 * decision.size.y * sqrt(squared(row_of(clip, 1u).xyz));
        // What lies at the eye or behind it is refined to the end.
        precise float away = max(min(before(depth, a), before(depth, b)), 1e-37);
        precise float level = sqrt(squared(a - b)) * max(right, down) / away / decision.measure;
        return level;
    }
    vec3 eye = views[seen].eye;
    precise float away = sqrt(min(squared(a - eye), squared(b - eye)));
    precise float level = decision.level * (decision.measure / max(away, decision.measure));
    return level;
}

// The level of a side of a patch: of its edge, or the greatest of its face's edges; in all views that are drawn together.
float level_of_side(uint list, uint seen, uint eyes) {
    uint place = bases.own[TABLES + CACHED_TABLES + 1u] + list;
    uint count = words[place];
    // The greatest is no less than the least.
    if ((decision.flags & (DECIDE_DISTANCE | DECIDE_SCREEN)) == 0u) return decision.level;
    float greatest = (decision.flags & FRAME_FRACTIONAL_EVEN) != 0u ? 2.0 : 1.0;
    uint edges = count == 2u ? 1u : count;
    for (uint i = 0u; i < edges * eyes; ++i) {
        uint edge = i % edges;
        vec3 a = positions[words[place + 1u + edge]];
        vec3 b = positions[words[place + 1u + (edge + 1u) % count]];
        float level = level_of_ends(seen + i / edges, a, b);
        // What is no number is no level.
        if (level > greatest) greatest = level;
    }
    return min(greatest, decision.level);
}

// Whether all vertices are outside of one side of the picture, by a thousandth of it and by what displacement and rounding can be.
bool is_outside(Patch record, uint hull, uint seen) {
    mat4 clip = views[seen].clip_from_model;
    vec4 depth = row_of(clip, 3u);
    float height = abs(views[seen].displacement.x);
    for (uint side = 0u; side < 6u; ++side) {
        vec4 across = row_of(clip, side >> 1u);
        // w + x, w - x, w + y, w - y, z, w - z.
        vec4 plane = side == 4u ? across : (side & 1u) == 0u ? depth + across : depth - across;
        float reach = height * sqrt(squared(plane.xyz));
        bool outside = true;
        for (uint i = 0u; i < hull && outside; ++i) {
            vec3 point = positions[words[bases.controls + record.controls + i]];
            vec3 summands = abs(plane.xyz * point);
            float rounding = 1e-6 * (summands.x + summands.y + summands.z + abs(plane.w));
            float margin = reach + rounding + 0.002 * abs(before(depth, point));
            outside = before(plane, point) < -margin;
        }
        if (outside) return true;
    }
    return false;
}

void main() {
    uint number = gl_GlobalInvocationID.x;
    if (number >= bases.patches) return;
    uint eyes = max(decision.flags >> FRAME_EYES_SHIFT & 63u, 1u);
    uint offset = gl_GlobalInvocationID.y * eyes;
    uint seen = decision.seen + offset;
    Patch record = patches[number];
    PatchSides sides = patch_sides[bases.own[TABLES + CACHED_TABLES] + number];
    bool drawn = (decision.flags & DECIDE_FRUSTUM) == 0u || sides.hull == 0u;
    for (uint eye = 0u; eye < eyes && !drawn; ++eye) drawn = !is_outside(record, sides.hull, seen + eye);
    drawn = drawn && (record.flags & PATCH_VACANT) == 0u;
    vec4 edges = vec4(0.0);
    float inside = 0.0;
    if (drawn) {
        bool fractional_even = (decision.flags & FRAME_FRACTIONAL_EVEN) != 0u;
        bool is_half = (record.flags & PATCH_HALF) != 0u;
        for (uint i = 0u; i < 4u; ++i) {
            float level = level_of_side(sides.sides[i], seen, eyes);
            bool even = (record.flags & (PATCH_EVEN_EDGE << i)) != 0u;
            float halved = half_level(level, fractional_even);
            edges[i] = is_half ? halved : even ? 2.0 * halved : level;
            inside = max(inside, is_half ? halved : level);
        }
    }
    for (uint eye = 0u; eye < eyes; ++eye) {
        uint place = (decision.view + offset + eye) * bases.patches + number;
        draws[place].edges = edges;
        draws[place].inside = inside;
    }
}
