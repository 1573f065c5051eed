#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/views.glsl"

layout(location = 0) out uint out_colour;

void main() {
    out_colour = part(0u);
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
