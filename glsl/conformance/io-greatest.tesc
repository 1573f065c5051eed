#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/io-greatest.glsl"

// The host writes another number in the module.
layout(vertices = 32) out;

layout(location = 0) in uint in_vertex[];
layout(location = 1) in uint in_instance[];

layout(location = 0) out vec4 out_values[][VALUES];
layout(location = 15) patch out vec4 out_lists[LISTS];
layout(location = 29) patch out uint out_patch;
out gl_PerVertex { vec4 gl_Position; } gl_out[];

void main() {
    uint number = in_vertex[0] / POINTS;
    uint self = uint(gl_InvocationID);
    for (uint k = 0u; k < VALUES; ++k) out_values[gl_InvocationID][k] = values(number, 10u * k, self);
    gl_out[gl_InvocationID].gl_Position = values(number, 300u, self);
    if (self == 0u) {
        for (uint k = 0u; k < LISTS; ++k) out_lists[k] = values(number, 400u, k);
        out_patch = number;
        for (uint k = 0u; k < 4u; ++k) gl_TessLevelOuter[k] = draw.outer[k];
        for (uint k = 0u; k < 2u; ++k) gl_TessLevelInner[k] = draw.inner[k];
    }
}
