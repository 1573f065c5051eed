#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/precision.glsl"

layout(location = 0) out uint out_number;

void main() {
    evaluate(0u, uint(gl_VertexIndex));
    out_number = uint(gl_VertexIndex);
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
