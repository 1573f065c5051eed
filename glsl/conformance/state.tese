#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/state.glsl"

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_number;
layout(location = 0) flat out uint out_number;

void main() {
    atomicAdd(counts[draw.number].runs, 1u);
    out_number = in_number;
    gl_Position = in_cell(gl_TessCoord.xy);
}
