#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/views.glsl"

layout(location = 0) flat in uint in_colour;
layout(location = 0) out vec4 out_colour;

// A colour of 24 bits: black is the background's.
void main() {
    uint number = in_colour + part(3u) + 1u;
    out_colour = vec4(number & 255u, number >> 8u & 255u, number >> 16u & 255u, 255u) / 255.0;
}
