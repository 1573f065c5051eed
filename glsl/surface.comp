#version 460
#extension GL_GOOGLE_include_directive : require

// The control points of a patch a workgroup, into the cache of a pose: what a control shader computes for the ring, with the same bits.

#define CACHED_POINTS

#include "lib/interface.glsl"
#include "method"

layout(local_size_x = CONTROL_INVOCATIONS) in;

void main() {
    uint number = frame.first_patch + gl_WorkGroupID.x;
    if (number >= frame.end_patch) return;
    Patch record = patch_record(number);
    uint level = required_level(patch_levels(number, record));
    run_stencils(record, slot_of(number), level, scratch_points(record, level));
}
