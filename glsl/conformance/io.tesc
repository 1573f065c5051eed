#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/io.glsl"

// The host writes another number in the module.
layout(vertices = 32) out;

layout(location = 0) in uint in_vertex[];
layout(location = 1) in uint in_instance[];

layout(location = 0) patch out uint out_patch;
layout(location = 1) patch out vec4 out_list[3];
layout(location = 4) patch out Pair {
    vec2 pair;
    float one;
} out_pair;
layout(location = 6) out vec4 out_value[];
layout(location = 7) out vec3 out_array[][2];
layout(location = 9) out ivec2 out_whole[];
layout(location = 10) out Corner {
    vec3 direction;
    float weights[2];
} out_corner[];
out gl_PerVertex { vec4 gl_Position; } gl_out[];

void main() {
    uint number = in_vertex[0] / POINTS;
    uint self = uint(gl_InvocationID);
    compare(uint(gl_PatchVerticesIn) == POINTS + draw.fault, 0u, number, self);
    for (uint i = 0u; i < POINTS; ++i) {
        compare(in_vertex[i] == number * POINTS + i, 1u, number, i);
        compare(gl_in[i].gl_Position == vec4(0.0, 0.0, 0.0, 1.0), 2u, number, i);
    }
    if (MODE == 3u) {
        // Undefined, and no more than that.
        uint behind = in_vertex[gl_MaxPatchVertices - 1] + in_instance[gl_MaxPatchVertices - 1];
        compare(behind <= 0xffffffffu, 3u, number, self);
    }
    out_value[gl_InvocationID] = vec4(content(number, 10u, self), content(number, 11u, self), content(number, 12u, self), content(number, 13u, self));
    for (uint k = 0u; k < 2u; ++k) out_array[gl_InvocationID][k] = vec3(content(number, 20u + k, self), content(number, 22u + k, self), content(number, 24u + k, self));
    if (MODE != 2u) out_whole[gl_InvocationID] = ivec2(content(number, 30u, self), -content(number, 31u, self));
    out_corner[gl_InvocationID].direction = vec3(content(number, 32u, self), content(number, 33u, self), content(number, 34u, self));
    for (uint k = 0u; k < 2u; ++k) out_corner[gl_InvocationID].weights[k] = content(number, 35u + k, self);
    gl_out[gl_InvocationID].gl_Position = vec4(content(number, 40u, self), 0.5, -1.0, 1.0);
    uint writers = MODE == 1u ? draw.vertices : 1u;
    for (uint k = 0u; k < 3u; ++k) {
        if (self == k % writers) out_list[k] = vec4(content(number, 50u, k), content(number, 51u, k), content(number, 52u, k), content(number, 53u, k));
    }
    if (self == 3u % writers) {
        out_pair.pair = vec2(content(number, 60u, 0u), content(number, 61u, 0u));
        out_pair.one = content(number, 62u, 0u);
    }
    if (self == 4u % writers) out_patch = number;
    if (self == 5u % writers) {
        for (uint k = 0u; k < 4u; ++k) gl_TessLevelOuter[k] = draw.outer[k];
        for (uint k = 0u; k < 2u; ++k) gl_TessLevelInner[k] = draw.inner[k];
    }
}
