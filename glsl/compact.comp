#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// From what was decided about all patches to those that are drawn in each view: their list, in the order of patches, in batches that fit into the scratch ring by
// what each needs there, and the commands of these. Twin of `frame/compaction.rs`, which says why batches are windows.
//
// Sums are those of whole numbers, in an order of their own: nothing depends on what runs when.

#include "lib/cells.glsl"

layout(local_size_x = DECIDE_INVOCATIONS) in;

layout(push_constant, scalar) uniform CompactionBlock { Compaction compaction; };

layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer PatchTable { Patch patches[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer WordTable { uint words[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer SideTable { PatchSides patch_sides[]; };
layout(set = SET_TABLES, binding = BINDING_BASES, scalar) uniform BaseBlock { Bases bases; };
// What is decided, and behind that of all views what is made of it.
layout(set = SET_FRAME, binding = BINDING_DRAWS, scalar) buffer DrawTable { PatchDraw draws[]; };
layout(set = SET_FRAME, binding = BINDING_DRAWS, scalar) buffer ListTable { uint lists[]; };

// Of some patches: how many are drawn, the points that they need in the ring, and the most segments of an edge.
struct Needs {
    uint drawn;
    uint points;
    uint segments;
};

shared Needs sums[DECIDE_INVOCATIONS];

Needs joined(Needs a, Needs b) { return Needs(a.drawn + b.drawn, a.points + b.points, max(a.segments, b.segments)); }

// What all of the workgroup have, whoever adds first: in place of the first sum.
void sum_all(Needs own) {
    uint number = gl_LocalInvocationIndex;
    sums[number] = Needs(0u, 0u, 0u);
    barrier();
    if (own.drawn != 0u) {
        atomicAdd(sums[0].drawn, own.drawn);
        atomicAdd(sums[0].points, own.points);
        atomicMax(sums[0].segments, own.segments);
    }
    barrier();
}

// What all invocations have up to this one, with its own (Hillis, Steele 1986).
Needs summed(Needs own) {
    uint number = gl_LocalInvocationIndex;
    barrier();
    sums[number] = own;
    barrier();
    for (uint away = 1u; away < DECIDE_INVOCATIONS; away *= 2u) {
        Needs before = sums[number >= away ? number - away : number];
        barrier();
        if (number >= away) sums[number] = joined(before, sums[number]);
        barrier();
    }
    return sums[number];
}

uint workgroups() { return (bases.patches + DECIDE_INVOCATIONS - 1u) / DECIDE_INVOCATIONS; }

// Words from a view to the next: batches, list, what each workgroup needs, and what all do.
uint view_words() { return compaction.list - compaction.batches + bases.patches + NEEDS_WORDS * (workgroups() + 1u); }

uint batch_at(uint view, uint batch) { return compaction.batches + view * view_words() + BATCH_WORDS * batch; }

uint list_at(uint view) { return compaction.list + view * view_words(); }

Needs needs_of(uint view, uint workgroup) {
    uint at = list_at(view) + bases.patches + NEEDS_WORDS * workgroup;
    return Needs(lists[at], lists[at + 1u], lists[at + 2u]);
}

void keep_needs(uint view, uint workgroup, Needs needs) {
    uint at = list_at(view) + bases.patches + NEEDS_WORDS * workgroup;
    lists[at] = needs.drawn;
    lists[at + 1u] = needs.points;
    lists[at + 2u] = needs.segments;
}

// What a patch needs in a view.
Needs patch_needs(uint view, uint number) {
    if (number >= bases.patches) return Needs(0u, 0u, 0u);
    PatchDraw draw = draws[view * bases.patches + number];
    if (!(draw.inside > 0.0)) return Needs(0u, 0u, 0u);
    Patch record = patches[number];
    bool macro_face = (record.flags & PATCH_MACRO) != 0u;
    uvec2 cells = cells_of(record);
    float greatest = max(draw.inside, max(max(draw.edges.x, draw.edges.y), max(draw.edges.z, draw.edges.w)));
    // A macro face of one row has two segments across at least.
    uint level = macro_face && any(equal(cells, uvec2(1u))) ? 1u : 0u;
    while (level < HIGHEST_LEVEL && float(1u << level) < greatest) ++level;
    bool fractional_even = (compaction.flags & FRAME_FRACTIONAL_EVEN) != 0u;
    uint segments = fractional_even ? 2u * uint(ceil(greatest * 0.5)) : uint(ceil(greatest));
    uint points = 0u;
    if ((compaction.flags & COMPACT_POINTS) != 0u) {
        uint base = TABLES + CACHED_TABLES;
        points = words[bases.own[base + 1u] + patch_sides[bases.own[base] + number].needs + level];
    }
    return Needs(1u, points, macro_face ? segments * max(cells.x, cells.y) : segments);
}

void count(uint view, uint workgroup) {
    sum_all(patch_needs(view, gl_GlobalInvocationID.x));
    if (gl_LocalInvocationIndex == 0u) keep_needs(view, workgroup, sums[0]);
}

// One workgroup a view: what all before each need, and behind them all.
void sum_up(uint view) {
    uint number = gl_LocalInvocationIndex;
    Needs all = Needs(0u, 0u, 0u);
    uint count = workgroups();
    for (uint first = 0u; first < count; first += DECIDE_INVOCATIONS) {
        bool there = first + number < count;
        Needs own = Needs(0u, 0u, 0u);
        if (there) own = needs_of(view, first + number);
        Needs upto = summed(own);
        Needs before = Needs(all.drawn + upto.drawn - own.drawn, all.points + upto.points - own.points, own.segments);
        if (there) keep_needs(view, first + number, before);
        all = joined(all, sums[DECIDE_INVOCATIONS - 1u]);
    }
    if (number == 0u) keep_needs(view, count, all);
    // Batches that nothing falls into begin where all ends.
    for (uint batch = number; batch < compaction.count; batch += DECIDE_INVOCATIONS) {
        lists[batch_at(view, batch) + BATCH_FIRST] = batch == 0u ? 0u : all.drawn;
    }
}

void list(uint view, uint eyes, uint workgroup) {
    uint number = gl_GlobalInvocationID.x;
    Needs own = patch_needs(view, number);
    Needs upto = summed(own);
    if (own.drawn == 0u) return;
    Needs before = needs_of(view, workgroup);
    uint rank = before.drawn + upto.drawn - 1u;
    uint points = before.points + upto.points - own.points;
    lists[list_at(view) + rank] = number;
    bool by_points = (compaction.flags & COMPACT_POINTS) != 0u;
    uint place = by_points ? points : rank;
    uint next = by_points ? points + own.points : rank + 1u;
    uint within = place % compaction.window;
    uint slot = by_points ? within : within * compaction.points;
    for (uint eye = 0u; eye < eyes; ++eye) draws[(view + eye) * bases.patches + number].slot = slot;
    uint last = min(next / compaction.window, compaction.count - 1u);
    for (uint batch = place / compaction.window + 1u; batch <= last; ++batch) {
        lists[batch_at(view, batch) + BATCH_FIRST] = rank + 1u;
    }
}

void command(uint view) {
    uint batch = gl_GlobalInvocationID.x;
    if (batch >= compaction.count) return;
    Needs all = needs_of(view, workgroups());
    uint at = batch_at(view, batch);
    uint first = lists[at + BATCH_FIRST];
    uint end = all.drawn;
    if (batch + 1u < compaction.count) end = lists[batch_at(view, batch + 1u) + BATCH_FIRST];
    uint count = end - first;
    // As many instances as drivers ask for that bound their vertices.
    uint most = max(compaction.instance_vertices / ((all.segments + 1u) * (all.segments + 1u)), 1u);
    if (compaction.instance_vertices == 0u) most = max(count, 1u);
    uint instances = (count + most - 1u) / most;
    uint per_instance = (count + max(instances, 1u) - 1u) / max(instances, 1u);
    lists[at] = per_instance * (compaction.flags >> COMPACT_CONTROLS_SHIFT & 63u);
    lists[at + 1u] = instances;
    lists[at + 2u] = 0u;
    lists[at + 3u] = (compaction.flags & COMPACT_FIRST_INSTANCE) != 0u ? view * bases.patches : 0u;
    lists[at + BATCH_PATCHES] = count;
    lists[at + BATCH_PER_INSTANCE] = per_instance;
}

void main() {
    uint eyes = max(compaction.flags >> FRAME_EYES_SHIFT & 63u, 1u);
    uint view = compaction.view + gl_WorkGroupID.y * eyes;
    switch (compaction.flags >> COMPACT_STEP_SHIFT & 3u) {
    case COMPACT_COUNT: count(view, gl_WorkGroupID.x); return;
    case COMPACT_SUM: sum_up(view); return;
    case COMPACT_LIST: list(view, eyes, gl_WorkGroupID.x); return;
    default: command(view);
    }
}
