#version 460
#extension GL_GOOGLE_include_directive : require

#define PRECISE
#include "conformance/precision.glsl"

layout(quads, equal_spacing, ccw) in;

layout(xfb_buffer = 0, xfb_stride = 12) out;

layout(location = 0) patch in uint in_number;
layout(location = 0, xfb_buffer = 0, xfb_offset = 0) flat out uint out_number;
invariant layout(location = 1, xfb_buffer = 0, xfb_offset = 4) out vec2 out_value;

void main() {
    out_number = in_number;
    vec4 a = inputs[in_number].a;
    vec4 b = inputs[in_number].b;
    out_value = vec2(evaluated(a, b), evaluated(b, a));
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
