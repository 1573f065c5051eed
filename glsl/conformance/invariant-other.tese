#version 460
#extension GL_GOOGLE_include_directive : require

#define PRECISE
#include "conformance/precision.glsl"

// The same values, beside others that are made of their parts.
layout(quads, equal_spacing, ccw) in;

layout(xfb_buffer = 0, xfb_stride = 12) out;

layout(location = 0) patch in uint in_number;
layout(location = 0, xfb_buffer = 0, xfb_offset = 0) flat out uint out_number;
invariant layout(location = 1, xfb_buffer = 0, xfb_offset = 4) out vec2 out_value;
layout(location = 2) out vec4 out_products;
layout(location = 3) out vec4 out_sums;

void main() {
    out_number = in_number;
    vec4 a = inputs[in_number].a;
    vec4 b = inputs[in_number].b;
    out_products = vec4(a.x * b.x, a.x * b.y, a.y * b.x, b.x * b.x * b.x) * gl_TessCoord.x;
    out_sums = vec4(a.x + a.y, a.x + b.x, a.y - a.x, 1.0 - b.x) + out_products.yzwx;
    out_value = vec2(evaluated(a, b), evaluated(b, a));
    outputs[in_number] = out_products.x + out_sums.y;
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, out_products.w, 1.0);
}
