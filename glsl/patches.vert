#version 460
#extension GL_GOOGLE_include_directive : require

// A vertex a patch, for geometry shaders: they get its number, and the view's.

#include "lib/instances.glsl"
#include "lib/interface.glsl"

layout(location = 0) flat out uint out_patch;
layout(location = 1) flat out uint out_view;

void main() {
    out_patch = frame.first_patch + instance_part() * frame.patches_per_instance + uint(gl_VertexIndex);
    out_view = instance_view();
}
