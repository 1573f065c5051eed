#version 460
#extension GL_GOOGLE_include_directive : require

// A vertex a patch, for geometry shaders: they get its number.

#include "lib/interface.glsl"

layout(location = 0) flat out uint out_patch;

void main() { out_patch = frame.first_patch + uint(gl_VertexIndex); }
