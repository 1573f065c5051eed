#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/state.glsl"

layout(location = 0) flat out uint out_number;

// Without patches, triangles: half of the cell each.
void main() {
    uint i = uint(gl_VertexIndex);
    vec2 corners[6] = vec2[](vec2(0.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(1.0), vec2(0.0, 1.0), vec2(1.0, 0.0));
    if (POINTS == 0u) atomicAdd(counts[draw.number].runs, 1u);
    out_number = draw.number;
    gl_Position = in_cell(corners[i % 6u]);
}
