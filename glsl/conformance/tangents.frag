#version 460
#extension GL_GOOGLE_include_directive : require

// One of the numbers that an evaluating shader hands on at the vertex that a triangle is flat by, bit by bit as a colour.

#include "lib/interface.glsl"

layout(constant_id = 0) const uint WHICH = 0u;

layout(location = 1) flat in vec3 in_normal;
layout(location = 2) flat in vec2 in_uv;
layout(location = 4) flat in uint in_drawn;
layout(location = 5) flat in vec3 in_du;
layout(location = 6) flat in vec3 in_dv;

layout(location = 0) out vec4 out_colour;

void main() {
    // No patch is 0: that is where nothing is drawn.
    float numbers[12] = float[](float(drawn_patch(in_drawn) + 1u), in_uv.x, in_uv.y, in_normal.x, in_normal.y, in_normal.z,
                                in_du.x, in_du.y, in_du.z, in_dv.x, in_dv.y, in_dv.z);
    out_colour = unpackUnorm4x8(floatBitsToUint(numbers[WHICH]));
}
