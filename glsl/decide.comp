#version 460
#extension GL_GOOGLE_include_directive : require
// What is drawn of each patch in each view: its levels, or nothing of it. An invocation a patch and view. Twin of `frame/decision.rs`.
//
// A level depends on the edge alone, whose ends are the same numbers in the same order for both patches there: so both have the same bits. They are the limits
// that `limits.comp` has found.

#include "lib/culling.glsl"
#include "lib/deciding.glsl"
#include "lib/half_level.glsl"

layout(local_size_x = DECIDE_INVOCATIONS) in;

layout(set = SET_POSE, binding = BINDING_LIMITS, scalar) readonly buffer LimitTable { Point limits[]; };

// The level that an edge of the mesh is to have, seen from one view.
float level_of_ends(uint seen, uint from, uint to) {
    if ((decision.flags & DECIDE_CURVATURE) != 0u) {
        vec3 normal = limits[from].normal;
        vec3 other = limits[to].normal;
        precise float turned = 2.0 * atan(sqrt(squared(normal - other)), sqrt(squared(normal + other)));
        precise float level = turned / decision.measure;
        return level;
    }
    vec3 a = limits[from].position;
    vec3 b = limits[to].position;
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
    uint place = side_list(list);
    uint count = words[place];
    // The greatest is no less than the least.
    if ((decision.flags & (DECIDE_DISTANCE | DECIDE_SCREEN | DECIDE_CURVATURE)) == 0u) return decision.level;
    float greatest = (decision.flags & FRAME_FRACTIONAL_EVEN) != 0u ? 2.0 : 1.0;
    uint edges = count == 2u ? 1u : count;
    for (uint i = 0u; i < edges * eyes; ++i) {
        uint edge = i % edges;
        float level = level_of_ends(seen + i / edges, words[place + 1u + edge], words[place + 1u + (edge + 1u) % count]);
        // What is no number is no level.
        if (level > greatest) greatest = level;
    }
    return min(greatest, decision.level);
}

shared uint beyond;

// Whether in all views that are drawn together everything is outside, since the box around all vertices is: beyond one side. Then no patch need be looked at.
// All invocations of a workgroup ask, each for a corner and a side.
bool is_all_outside(uint seen, uint eyes) {
    uint own = gl_LocalInvocationIndex;
    bool outside = true;
    for (uint eye = 0u; eye < eyes; ++eye) {
        if (own == 0u) beyond = 63u;
        barrier();
        uint side = own >> 3u;
        if (side < 6u) {
            View view = views[seen + eye];
            vec4 plane = side_of(view.clip_from_model, side);
            float reach = abs(view.displacement.x) * sqrt(squared(plane.xyz));
            Point box = limits[decision.vertices];
            vec3 corner = mix(box.position, box.normal, notEqual(uvec3(own) & uvec3(1u, 2u, 4u), uvec3(0u)));
            // What is no number is not outside.
            bool out_there = inside_of(plane, row_of(view.clip_from_model, 3u), reach, corner) < 0.0;
            if (!out_there) atomicAnd(beyond, ~(1u << side));
        }
        barrier();
        outside = outside && beyond != 0u;
        barrier();
    }
    return outside;
}

// Why a patch is not drawn in any of the views that are drawn together, whatever its levels; 0 where it is.
uint culled_by(Patch record, PatchSides sides, bool all_outside, uint seen, uint eyes) {
    Hull hull = hull_of(record, sides);
    bool outside = (decision.flags & DECIDE_FRUSTUM) != 0u && hull.count > 0u;
    bool small = (decision.flags & DECIDE_SMALL) != 0u && hull.count > 0u;
    for (uint eye = 0u; eye < eyes && outside && !all_outside; ++eye) outside = is_outside(sides, hull, seen + eye);
    if (outside) return DECIDE_FRUSTUM;
    for (uint eye = 0u; eye < eyes && small; ++eye) small = is_small(hull, seen + eye);
    return small ? DECIDE_SMALL : 0u;
}

// How deep is refined around all irregularities, of methods that go as deep as a frame needs. Twin of `depth_at` in `method/depths.rs`.
uint depth_of_frame() {
    uint depth = LEAST_DEPTH;
    while (depth < GREATEST_DEPTH && float(1u << depth) < decision.level) ++depth;
    return depth;
}

void main() {
    uint number = gl_GlobalInvocationID.x;
    uint eyes = max(decision.flags >> FRAME_EYES_SHIFT & 63u, 1u);
    uint offset = gl_GlobalInvocationID.y * eyes;
    uint seen = decision.seen + offset;
    bool all_outside = false;
    if ((decision.flags & DECIDE_FRUSTUM) != 0u) all_outside = is_all_outside(seen, eyes);
    if (number >= bases.patches) return;
    Patch record = patches[number];
    PatchSides sides = patch_sides[bases.own[TABLES + CACHED_TABLES] + number];
    uint culled = culled_by(record, sides, all_outside, seen, eyes);
    vec4 edges = vec4(0.0);
    float inside = 0.0;
    uint halvings = patch_halvings(record);
    uint depth = depth_of_frame();
    bool dynamic = (sides.hull & HULL_DYNAMIC) != 0u;
    bool shallow = (sides.hull & HULL_SHALLOW) != 0u;
    bool drawn = !dynamic || (shallow ? halvings == depth : halvings <= depth);
    if (culled == 0u && drawn && (record.flags & PATCH_VACANT) == 0u) {
        bool fractional_even = (decision.flags & FRAME_FRACTIONAL_EVEN) != 0u;
        for (uint i = 0u; i < 4u; ++i) {
            float level = halved_level(level_of_side(sides.sides[i], seen, eyes), halvings, fractional_even);
            // At the last depth there are no smaller patches beyond.
            bool even = (record.flags & (PATCH_EVEN_EDGE << i)) != 0u && (!dynamic || halvings < depth);
            float halved = half_level(level, fractional_even);
            edges[i] = even ? 2.0 * halved : level;
            inside = max(inside, level);
        }
        bool back = (decision.flags & DECIDE_BACK) != 0u && (sides.hull & HULL_SPLINE) != 0u;
        for (uint eye = 0u; eye < eyes && back; ++eye) back = is_back(record, seen + eye, edges, inside);
        if (back) {
            culled = DECIDE_BACK;
            edges = vec4(0.0);
            inside = 0.0;
        }
    }
    for (uint eye = 0u; eye < eyes; ++eye) {
        uint place = (decision.view + offset + eye) * bases.patches + number;
        draws[place].slot = culled;
        draws[place].edges = edges;
        draws[place].inside = inside;
    }
}
