// Adaptive quadtrees (Brainerd et al. 2016) for faces that are no plain B-splines. Twin of `method/quadtree/twin.rs`.
//
// The control points of a patch are the vertices of its 1-ring, up to 32; what a larger ring has beyond these is fetched by the control
// shader itself (section 5).
//
// A patch's slot in the scratch ring begins with a head for each of its uses: the origin that the use's points are relative to, and where
// these begin in the slot. Then come the plain vertices of its border, and the points of each plan.
#ifndef QUADTREE_METHOD_GLSL
#define QUADTREE_METHOD_GLSL

#define SCRATCH_RING

#include "lib/border.glsl"
#include "lib/cell.glsl"
#include "lib/control_vertex.glsl"
#include "lib/corner.glsl"
#include "lib/levels.glsl"
#include "lib/quadtree.glsl"
#include "lib/scratch.glsl"

const uint CONTROL_POINTS = CONTROL_INVOCATIONS;
#define CONTROL_VERTICES 32

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) {
    uint ring_size = plans[borders[record.plan].plans[0]].ring_size;
    return control_vertex(controls[record.controls + min(number, ring_size - 1u)]);
}
#endif

#ifdef STAGE_CONTROL
uint scratch_points(Patch record, uint level) { return borders[record.plan].counts[min(level, HIGHEST_LEVEL)]; }

// A vertex of the patch's 1-ring. The index is clamped although it is only used when it is small: a driver may fetch first and choose then.
vec3 ring_point(Patch record, uint place) {
    vec3 piped = in_point[min(place, CONTROL_POINTS - 1u)];
    return place < CONTROL_POINTS ? piped : control_vertex(controls[record.controls + place]);
}

// Adds `term` to a sum of many, and keeps what rounding takes away (Kahan 1965).
void add_compensated(inout vec3 sum, inout vec3 lost, vec3 term) {
    precise vec3 rest = term - lost;
    precise vec3 next = sum + rest;
    precise vec3 more = (next - sum) - rest;
    sum = next;
    lost = more;
}

// A stencil's sum over the ring of a plan, relative to `origin`: tangents deep in the tree are differences of small numbers then. `places`
// is where it stands which vertices of the patch's ring these are; the plan of the inside has them all.
//
// Rings too long for the vertex shader are also too long for a plain sum: where hundreds of faces meet, the tangents of neighbours differ by
// less than it would lose.
vec3 stencil_point(Patch record, PlanHeader plan, bool inside, uint places, vec3 origin, uint number) {
    uint weight = plan.weights + number * plan.ring_size;
    bool plain = plan.ring_size <= CONTROL_POINTS;
    precise vec3 sum = vec3(0.0);
    for (uint i = 0u; i < (plain && inside ? plan.ring_size : 0u); ++i) {
        sum += weights[weight + i] * (in_point[i] - origin);
    }
    for (uint i = 0u; i < (plain && !inside ? plan.ring_size : 0u); ++i) {
        sum += weights[weight + i] * (ring_point(record, controls[places + i]) - origin);
    }
    vec3 lost = vec3(0.0);
    for (uint i = 0u; i < (plain ? 0u : plan.ring_size); ++i) {
        precise vec3 term = weights[weight + i] * (ring_point(record, inside ? i : controls[places + i]) - origin);
        add_compensated(sum, lost, term);
    }
    return sum;
}

// The pair of tangents whose first is stencil `number`, as `stencil_point`.
Tangents ring_tangents(Patch record, PlanHeader plan, bool inside, uint places, uint number) {
    uint weight = plan.weights + number * plan.ring_size;
    vec3 origin = ring_point(record, inside ? 0u : controls[places]);
    vec3 du = vec3(0.0);
    vec3 dv = vec3(0.0);
    vec3 lost_u = vec3(0.0);
    vec3 lost_v = vec3(0.0);
    precise vec2 spread = vec2(0.0);
    precise vec2 total = vec2(0.0);
    for (uint i = 0u; i < plan.ring_size; ++i) {
        precise vec3 spoke = ring_point(record, inside ? i : controls[places + i]) - origin;
        vec2 pair = vec2(weights[weight + i], weights[weight + plan.ring_size + i]);
        precise vec3 along_u = pair.x * spoke;
        precise vec3 along_v = pair.y * spoke;
        add_compensated(du, lost_u, along_u);
        add_compensated(dv, lost_v, along_v);
        spread += abs(pair) * reach(spoke);
        total += abs(pair);
    }
    return Tangents(du, dv, rounding_errors(spread, total, origin));
}

// The normal at the patch's corner that is use `number`. It depends on nothing but what all who share it have; at cusps, and between two sharp edges
// of a single face, on the face.
vec3 vertex_normal(Patch record, PlanHeader plan, uint number) {
    uint flags = borders[record.plan].flags[number];
    uint places = borders[record.plan].rings[number];
    uint tangents_nearby = borders[record.plan].nearby[number - 5u];
    bool has_nearby = tangents_nearby != NO_PLAN;
    vec3 nearby = vec3(0.0);
    if (has_nearby) {
        PlanHeader own = plans[borders[record.plan].plans[0]];
        own.ring_size = min(own.ring_size, uint(weights.length()));
        nearby = clear_normal(ring_tangents(record, own, true, 0u, tangents_nearby));
    }
    if ((flags & USE_CUSP) != 0u) return nearby;
    uint pair = 1u + 2u * (flags >> USE_SIDE_SHIFT);
    Tangents tangents = ring_tangents(record, plan, false, places, pair);
    vec3 limit = clear_normal(tangents);
    if (has_nearby) return normal_of_single(tangents, limit, nearby);
    if (limit == vec3(0.0) && (flags & USE_SPARE) != 0u) {
        return clear_normal(ring_tangents(record, plan, false, places, pair + 2u));
    }
    return limit;
}

// Where the parts of a slot end: the heads, the plain vertices, the points of each use's plan.
struct Parts {
    uint plain;
    uint ends[USES];
};

// How many points of a use's plan are in the slot.
uint use_points(PlanHeader header, uint flags, uint level) {
    bool halved = (flags & (USE_FIRST_HALF | USE_SECOND_HALF)) != 0u;
    return (flags & USE_LIMIT) != 0u ? 2u : header.counts[min(level + uint(halved), HIGHEST_LEVEL + 1u)];
}

// Writes the heads on the way, each by the invocation of its number.
Parts find_parts(Patch record, uint slot, uint level, uint count) {
    Parts parts;
    parts.plain = USES + borders[record.plan].plain_count;
    uint end = parts.plain;
    for (uint number = 0u; number < USES; ++number) {
        uint plan = borders[record.plan].plans[number];
        bool planned = plan != NO_PLAN;
        if (gl_InvocationID == number && count > 0u) {
            uint first = number == 0u ? 0u : controls[borders[record.plan].rings[number]];
            vec3 origin = planned ? ring_point(record, first) : vec3(0.0);
            scratch[slot + number] = vec4(origin, float(planned ? end : USES));
        }
        if (planned) end += use_points(plans[plan], borders[record.plan].flags[number], level);
        parts.ends[number] = end;
    }
    return parts;
}

// Point `next` of the slot, which is one of a plan. Each invocation finds the plan of its own point: parts are short, and if all went through
// them together most would wait most of the time.
vec3 plan_point(Patch record, Parts parts, uint level, uint count, uint next) {
    uint number = 0u;
    uint start = parts.plain;
    for (uint i = 0u; i < USES - 1u; ++i) {
        bool beyond = next >= parts.ends[i];
        number = beyond ? i + 1u : number;
        start = beyond ? parts.ends[i] : start;
    }
    uint plan = borders[record.plan].plans[number];
    uint flags = borders[record.plan].flags[number];
    uint places = borders[record.plan].rings[number];
    bool inside = number == 0u;
    PlanHeader header = plans[plan != NO_PLAN ? plan : 0u];
    // Bounded by the weights that there are: a plan that is garbage must not keep the device busy for ever.
    uint points = use_points(header, flags, level);
    header.ring_size = min(header.ring_size, uint(weights.length()) / max(min(points, count), 1u));
    uint stencil = next - start;
    if ((flags & USE_LIMIT) != 0u && stencil > 0u) return vertex_normal(record, header, number);
    vec3 origin = ring_point(record, inside ? 0u : controls[places]);
    return stencil_point(record, header, inside, places, origin, stencil);
}

// Fills the slot. Every 32nd point is this invocation's.
void run_stencils(Patch record, uint slot, uint level, uint count) {
    Parts parts = find_parts(record, slot, level, count);
    uint plain = borders[record.plan].plain - USES;
    uint next = USES + gl_InvocationID;
    for (; next < min(parts.plain, count); next += CONTROL_INVOCATIONS) {
        scratch[slot + next] = vec4(ring_point(record, controls[plain + next]), 0.0);
    }
    for (; next < count; next += CONTROL_INVOCATIONS) {
        scratch[slot + next] = vec4(plan_point(record, parts, level, count, next), 0.0);
    }
}
#endif

#ifdef STAGE_EVALUATION
vec3 scratch_point(uint first, uint number) { return scratch[first + node_point(number)].xyz; }

Row scratch_row(uint first, uint number, Basis u) {
    return bspline_row(u, scratch_point(first, number), scratch_point(first, number + 1u), scratch_point(first, number + 2u),
                       scratch_point(first, number + 3u));
}

// Not on infinite creases and at cusps.
bool has_one_normal(Patch record, vec2 uv) {
    return (borders[record.plan].flags[find_place(record.flags, uv).number] & USE_CREASED) == 0u;
}

// Row 1 is the position on an edge, row 2 that plus the derivative across.
const Basis CURVE = Basis(vec4(0.0, 1.0, 0.0, 0.0), vec4(0.0, -1.0, 1.0, 0.0));

// Inside by the patch's own plan, on edges and at corners by those that all faces there share.
Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    memoryBarrierBuffer();
    Place place = find_place(record.flags, uv);
    uint flags = borders[record.plan].flags[place.number];
    vec4 head = scratch[slot + place.number];
    uint first = slot + uint(head.w);
    if ((flags & USE_LIMIT) != 0u) {
        precise vec3 vertex = scratch[first].xyz + head.xyz;
        return Point(vertex, scratch[first + 1u].xyz);
    }
    vec2 local = place.number == 0u ? uv : vec2(place.number < 5u ? on_edge(flags, place.along) : 0.0, 0.0);
    Leaf leaf = find_leaf(borders[record.plan].roots[place.number], local);
    Basis u, v;
    creased_bases(leaf.uv, leaf.edge, leaf.sharpness, u, v);
    if (leaf.kind == NODE_CURVE) v = CURVE;
    uint row = leaf.points + 16u * (flags >> USE_SIDE_SHIFT);
    Surface surface = bspline_surface(v, leaf.scale, scratch_row(first, row, u), scratch_row(first, row + leaf.stride, u),
                              scratch_row(first, row + 2u * leaf.stride, u), scratch_row(first, row + 3u * leaf.stride, u));
    surface = turned(surface, flags >> USE_TURN_SHIFT & 3u);
    // Half of the edge is the whole patch.
    float scale = (flags & (USE_FIRST_HALF | USE_SECOND_HALF)) != 0u ? 0.5 : 1.0;
    precise vec3 position = surface.position + head.xyz;
    precise vec3 du = scale * surface.du;
    precise vec3 dv = scale * surface.dv;
    return surface_point(Surface(position, du, dv));
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) {
    Leaf leaf = find_leaf(borders[record.plan].roots[0], uv);
    return Cell(leaf.kind, leaf.uv, leaf.scale);
}
#endif

#endif
