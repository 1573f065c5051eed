#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/instances.glsl"
#include "lib/interface.glsl"
#include "method"

// The patch's number, or the sub-patch's, comes from here: gl_PrimitiveID is not to be relied on in later stages of some drivers.
layout(location = 0) out uint out_patch;
layout(location = 1) out vec3 out_point;
layout(location = 2) out uint out_view;

void main() {
    uint vertex = uint(gl_VertexIndex);
    out_patch = frame.first_patch + instance_part() * frame.patches_per_instance + vertex / CONTROL_POINTS;
    out_view = instance_view();
    out_point = control_point(patch_record(patch_of(out_patch)), vertex % CONTROL_POINTS);
}
