#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/compute.glsl"

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_number;

void main() {
    read_patch(in_number);
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
