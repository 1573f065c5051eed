#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/instances.glsl"
#include "lib/interface.glsl"
#include "method"

layout(set = SET_FRAME, binding = BINDING_DRAWS, scalar) readonly buffer ListTable { uint lists[]; };

// The patch's number, or the sub-patch's, comes from here: gl_PrimitiveID is not to be relied on in later stages of some drivers.
layout(location = 0) out uint out_patch;
layout(location = 1) out vec3 out_point;
layout(location = 2) out uint out_view;

// Where the device decides, an instance's commands tell its view themselves, and its batch which of the patches that are drawn there it has.
uint decided_patch(uint view, uint place) {
    uint batch = frame.first_patch + view * frame.patches_per_instance;
    uint at = instance_part() * lists[batch + BATCH_PER_INSTANCE] + place;
    if (at >= lists[batch + BATCH_PATCHES]) return NOT_DRAWN;
    return lists[frame.counter + view * frame.patches_per_instance + lists[batch + BATCH_FIRST] + at];
}

void main() {
    uint vertex = uint(gl_VertexIndex);
    uint place = vertex / CONTROL_POINTS;
    if ((frame.flags & FRAME_DECIDED) != 0u) {
        out_view = frame.view + uint(gl_InstanceIndex) / frame.instances;
        out_patch = decided_patch(out_view, place);
    } else {
        out_view = instance_view();
        out_patch = frame.first_patch + instance_part() * frame.patches_per_instance + place;
    }
    out_point = control_point(patch_record(patch_of(out_patch)), vertex % CONTROL_POINTS);
}
