#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef MULTIVIEW
#extension GL_EXT_multiview : require
#endif

#include "lib/interface.glsl"
#include "method"
#include "lib/sub_patch.glsl"
#include "lib/vertex.glsl"

// SPACING comes from the build: one module for equal_spacing, one for fractional_even_spacing.
// Clockwise where v grows downwards, from the upper left as Vulkan has it (Vulkan spec, "Tessellator Vertex Winding Order"): so triangles are
// counter-clockwise where their face is.
#ifdef TRIANGLES
layout(triangles, SPACING, cw) in;
#else
layout(quads, SPACING, cw) in;
#endif

layout(location = 0) patch in uint in_patch;
#ifdef SCRATCH_RING
layout(location = 1) patch in uint in_slot;
#else
#define in_slot slot_of(patch_of(in_patch))
#endif
layout(location = 3) patch in uint in_view;

// MULTIVIEW comes from the build as well: one module for rendering with a view mask.
#ifdef MULTIVIEW
#define SEEN_VIEW (in_view + uint(gl_ViewIndex))
#else
#define SEEN_VIEW in_view
#endif

// What the control shader decided.
Levels decided_levels() {
#ifdef TRIANGLES
    return Levels(vec4(gl_TessLevelOuter[2], gl_TessLevelOuter[0], gl_TessLevelOuter[1], 0.0), gl_TessLevelInner[0]);
#else
    return Levels(vec4(gl_TessLevelOuter[1], gl_TessLevelOuter[2], gl_TessLevelOuter[3], gl_TessLevelOuter[0]), gl_TessLevelInner[0]);
#endif
}

void main() {
    uint number = patch_of(in_patch);
    Patch record = patch_record(number);
#ifdef MACRO_FACES
    Levels levels = cell_levels(record, decided_levels());
#else
    Levels levels = decided_levels();
#endif
    vec2 uv = gl_TessCoord.xy;
#ifndef TRIANGLES
    if (are_sub_patches()) {
        levels = whole_levels(in_patch, in_view, record);
        uv = piece_coordinates(record, levels, sub_patches[sub_patch_at(in_patch)].piece, uv);
    }
#endif
    if (!are_sub_patches()) uv = shared_coordinates(record, levels, gl_TessCoord);
    if (TANGENTS) tangent_level = required_level(levels);
    write_vertex(record, number, SEEN_VIEW, uv, evaluate_patch(record, in_slot, uv));
    if (are_sub_patches()) out_drawn = drawn_key(in_patch, SEEN_VIEW);
}
