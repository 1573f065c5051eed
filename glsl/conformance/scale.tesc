#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/scale.glsl"

layout(constant_id = 0) const uint CONTROL_POINTS = 1u;

layout(vertices = 1) out;

layout(location = 0) in uint in_vertex[];
layout(location = 1) in uint in_instance[];
layout(location = 0) patch out uint out_patch;

void main() {
    uint local = (in_vertex[0] - draw.first_vertex) / CONTROL_POINTS;
    uint number = (in_instance[0] - draw.first_instance) * draw.per_instance + local;
    // All points of the patch are those of one patch, in order.
    uint bad = 0u;
    for (uint i = 0u; i < CONTROL_POINTS; ++i) {
        bool right = in_vertex[i] == draw.first_vertex + local * CONTROL_POINTS + i && in_instance[i] == in_instance[0];
        bad += right ? 0u : 1u;
    }
    if (number < draw.patches) {
        uint id = uint(gl_PrimitiveID);
        atomicAdd(notes[number].controls, 1u);
        atomicMax(notes[number].control_high, id + 1u);
        atomicMax(notes[number].control_low, ~id);
        atomicAdd(notes[number].bad_points, bad);
    }
    out_patch = number;
    for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = draw.level;
    for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = draw.level;
}
