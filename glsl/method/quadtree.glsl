// Adaptive quadtrees (Brainerd et al. 2016) for faces that are no plain B-splines. Twin of `method/quadtree.rs`.
//
// The control points of a patch are the vertices of its 1-ring, up to 32; what a larger ring has beyond these is fetched by the control
// shader itself (section 5). All are taken relative to the first, so that tangents deep in the tree are differences of small numbers.
#ifndef QUADTREE_METHOD_GLSL
#define QUADTREE_METHOD_GLSL

#define SCRATCH_RING

#include "lib/cell.glsl"
#include "lib/control_vertex.glsl"
#include "lib/levels.glsl"
#include "lib/quadtree.glsl"
#include "lib/scratch.glsl"

const uint CONTROL_POINTS = CONTROL_INVOCATIONS;
#define CONTROL_VERTICES 32

uint greatest_level(Patch record) { return plans[record.plan].max_level; }

vec3 patch_origin(Patch record) { return control_vertex(controls[record.controls]); }

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) {
    uint ring_size = plans[record.plan].ring_size;
    return control_vertex(controls[record.controls + min(number, ring_size - 1u)]) - patch_origin(record);
}
#endif

#ifdef STAGE_CONTROL
uint scratch_points(Patch record, uint level) { return plans[record.plan].counts[min(level, HIGHEST_LEVEL)]; }

// Adds `term` to a sum of many, and keeps what rounding takes away (Kahan 1965).
void add_compensated(inout vec3 sum, inout vec3 lost, vec3 term) {
    precise vec3 rest = term - lost;
    precise vec3 next = sum + rest;
    precise vec3 more = (next - sum) - rest;
    sum = next;
    lost = more;
}

// Runs every 32nd stencil, beginning with this invocation's. Rings too long for the vertex shader are also too long for a plain sum: where
// hundreds of faces meet, the tangents of neighbours differ by less than it would lose.
void run_stencils(Patch record, uint slot, uint count) {
    uint ring_size = plans[record.plan].ring_size;
    bool piped = ring_size <= CONTROL_POINTS;
    vec3 origin = piped ? vec3(0.0) : patch_origin(record);
    for (uint stencil = gl_InvocationID; stencil < count; stencil += CONTROL_INVOCATIONS) {
        uint weight = plans[record.plan].weights + stencil * ring_size;
        vec3 sum = vec3(0.0);
        vec3 lost = vec3(0.0);
        if (piped) {
            for (uint i = 0u; i < ring_size; ++i) sum += weights[weight + i] * in_point[i];
        } else {
            for (uint i = 0u; i < ring_size; ++i) {
                vec3 point = control_vertex(controls[record.controls + i]) - origin;
                add_compensated(sum, lost, weights[weight + i] * point);
            }
        }
        scratch[slot + stencil] = vec4(sum, 0.0);
    }
}
#endif

#ifdef STAGE_EVALUATION
vec3 scratch_point(uint slot, uint number) { return scratch[slot + node_point(number)].xyz; }

Surface evaluate_patch(Patch record, uint slot, vec2 uv) {
    memoryBarrierBuffer();
    vec3 origin = patch_origin(record);
    Leaf leaf = find_leaf(record.plan, uv);
    if (leaf.is_corner) {
        uint first = slot + 3u * leaf.corner;
        return Surface(scratch[first].xyz + origin, scratch[first + 1u].xyz, scratch[first + 2u].xyz);
    }
    Basis u, v;
    creased_bases(leaf.uv, leaf.edge, leaf.sharpness, u, v);
    Surface surface = Surface(vec3(0.0), vec3(0.0), vec3(0.0));
    for (uint y = 0u; y < 4u; ++y) {
        uint row = leaf.points + leaf.stride * y;
        add_row(surface, u, v.value[y], v.derivative[y], scratch_point(slot, row), scratch_point(slot, row + 1u),
                scratch_point(slot, row + 2u), scratch_point(slot, row + 3u));
    }
    return Surface(surface.position + origin, leaf.scale * surface.du, leaf.scale * surface.dv);
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) {
    Leaf leaf = find_leaf(record.plan, uv);
    return Cell(leaf.kind, leaf.uv, leaf.scale);
}
#endif

#endif
