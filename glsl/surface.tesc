#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/interface.glsl"

layout(location = 0) in uint in_patch[];
layout(location = 1) in vec3 in_point[];
layout(location = 2) in uint in_view[];

#include "method"
#include "lib/sub_patch.glsl"

layout(vertices = CONTROL_VERTICES) out;

layout(location = 0) patch out uint out_patch;
#ifdef SCRATCH_RING
layout(location = 1) patch out uint out_slot;
#else
layout(location = 2) out vec3 out_point[];
#endif
layout(location = 3) patch out uint out_view;

// barrier() may stand in main only, and in no control flow (GLSL 4.60, section 8.16).
void main() {
    uint number = in_patch[0];
    Patch record = patch_record(patch_of(number));
    Levels levels = whole_levels(number, in_view[0], record);
    // A patch that is decided not to be drawn has no level.
    bool drawn = number < frame.end_patch && levels.inside > 0.0;
#ifdef SCRATCH_RING
    uint level = required_level(levels);
#ifdef MACRO_FACES
    // Of one row there are two segments across at least.
    if (any(equal(cells_of(record), uvec2(1u)))) level = max(level, 1u);
#endif
    uint count = drawn ? scratch_points(record, level) : 0u;
    if (gl_InvocationID == 0) out_slot = take_slot(number, in_view[0], count);
    barrier();
    uint slot = out_slot;
    drawn = drawn && slot != NO_SLOT;
    run_stencils(record, slot, level, drawn ? count : 0u);
    memoryBarrierBuffer();
    barrier();
    memoryBarrierBuffer();
#else
    out_point[gl_InvocationID] = patch_point(record, gl_InvocationID);
#endif
    levels = tessellated_levels(number, levels);
    if (gl_InvocationID == 0) {
        out_patch = number;
        out_view = in_view[0];
        // Outer level 0 discards a patch (Vulkan spec, "Tessellator Patch Discard").
        vec4 edges = drawn ? levels.edges : vec4(0.0);
        vec2 inside = vec2(levels.inside);
#ifdef MACRO_FACES
        // Each cell has whole segments.
        vec2 cells = vec2(cells_of(record));
        precise vec4 whole_edges = ceil(edges) * cells.xyxy;
        precise vec2 whole_inside = ceil(inside) * cells;
        edges = whole_edges;
        inside = whole_inside;
#endif
#ifdef TRIANGLES
        // Level i belongs to the edge opposite to corner i (Vulkan spec, "Triangle Tessellation").
        gl_TessLevelOuter[0] = edges[1];
        gl_TessLevelOuter[1] = edges[2];
        gl_TessLevelOuter[2] = edges[0];
        gl_TessLevelInner[0] = inside.x;
#else
        gl_TessLevelOuter[0] = edges[3];
        gl_TessLevelOuter[1] = edges[0];
        gl_TessLevelOuter[2] = edges[1];
        gl_TessLevelOuter[3] = edges[2];
        gl_TessLevelInner[0] = inside.x;
        gl_TessLevelInner[1] = inside.y;
#endif
    }
}
