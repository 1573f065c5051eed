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

// Fills the slot. Every 32nd point, over all parts of the slot, is this invocation's.
void run_stencils(Patch record, uint slot, uint level, uint count) {
    uint next = USES + gl_InvocationID;
    uint end = USES + borders[record.plan].plain_count;
    uint plain = borders[record.plan].plain - USES;
    for (; next < min(end, count); next += CONTROL_INVOCATIONS) {
        scratch[slot + next] = vec4(ring_point(record, controls[plain + next]), 0.0);
    }
    for (uint number = 0u; number < USES; ++number) {
        uint plan = borders[record.plan].plans[number];
        uint flags = borders[record.plan].flags[number];
        uint places = borders[record.plan].rings[number];
        bool planned = plan != NO_PLAN;
        bool limit = (flags & USE_LIMIT) != 0u;
        bool halved = (flags & (USE_FIRST_HALF | USE_SECOND_HALF)) != 0u;
        PlanHeader header = plans[planned ? plan : 0u];
        bool inside = number == 0u;
        vec3 origin = planned ? ring_point(record, inside ? 0u : controls[places]) : vec3(0.0);
        uint start = planned ? end : USES;
        if (gl_InvocationID == number && count > 0u) scratch[slot + number] = vec4(origin, float(start));
        uint points = limit ? 3u : header.counts[min(level + uint(halved), HIGHEST_LEVEL + 1u)];
        // Bounded by the weights that there are: a plan that is garbage must not keep the device busy for ever.
        header.ring_size = min(header.ring_size, uint(weights.length()) / max(min(points, count), 1u));
        end += planned ? points : 0u;
        uint pair = limit ? 2u * (flags >> USE_SIDE_SHIFT) : 0u;
        for (; next < min(end, count); next += CONTROL_INVOCATIONS) {
            uint stencil = next - start;
            if (stencil > 0u) stencil += pair;
            scratch[slot + next] = vec4(stencil_point(record, header, inside, places, origin, stencil), 0.0);
        }
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
    Surface surface;
    if ((flags & USE_LIMIT) != 0u) {
        surface = Surface(scratch[first].xyz, scratch[first + 1u].xyz, scratch[first + 2u].xyz);
    } else {
        vec2 local = place.number == 0u ? uv : vec2(place.number < 5u ? on_edge(flags, place.along) : 0.0, 0.0);
        Leaf leaf = find_leaf(borders[record.plan].roots[place.number], local);
        Basis u, v;
        creased_bases(leaf.uv, leaf.edge, leaf.sharpness, u, v);
        if (leaf.kind == NODE_CURVE) v = CURVE;
        uint row = leaf.points + 16u * (flags >> USE_SIDE_SHIFT);
        surface = bspline_surface(v, leaf.scale, scratch_row(first, row, u), scratch_row(first, row + leaf.stride, u),
                                  scratch_row(first, row + 2u * leaf.stride, u), scratch_row(first, row + 3u * leaf.stride, u));
    }
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
