#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/barriers.glsl"

layout(location = 0) out uint out_vertex;

void main() {
    if (STORES == 1u) atomicAdd(stored[gl_VertexIndex], 1u);
    out_vertex = uint(gl_VertexIndex);
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
