#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/scale.glsl"

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_patch;
layout(location = 0) flat out uint out_patch;

void main() {
    if (in_patch < draw.patches) {
        uint id = uint(gl_PrimitiveID);
        atomicAdd(notes[in_patch].evaluations, 1u);
        atomicMax(notes[in_patch].evaluation_high, id + 1u);
        atomicMax(notes[in_patch].evaluation_low, ~id);
    }
    out_patch = in_patch;
    vec2 cell = vec2(in_patch % draw.columns, in_patch / draw.columns);
    gl_Position = vec4((cell + gl_TessCoord.xy) * draw.side - 1.0, 0.0, 1.0);
}
