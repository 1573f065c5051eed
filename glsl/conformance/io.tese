#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/io.glsl"

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_patch;
layout(location = 1) patch in vec4 in_list[3];
layout(location = 4) patch in Pair {
    vec2 pair;
    float one;
} in_pair;
layout(location = 6) in vec4 in_value[];
layout(location = 7) in vec3 in_array[][2];
layout(location = 9) in ivec2 in_whole[];
layout(location = 10) in Corner {
    vec3 direction;
    float weights[2];
} in_corner[];
in gl_PerVertex { vec4 gl_Position; } gl_in[gl_MaxPatchVertices];

void main() {
    uint number = in_patch;
    compare(uint(gl_PatchVerticesIn) == draw.vertices + draw.fault, 100u, number, 0u);
    for (uint i = 0u; i < draw.vertices; ++i) {
        vec4 value = vec4(content(number, 10u, i), content(number, 11u, i), content(number, 12u, i), content(number, 13u, i));
        compare(in_value[i] == value, 110u, number, i);
        for (uint k = 0u; k < 2u; ++k) {
            vec3 right = vec3(content(number, 20u + k, i), content(number, 22u + k, i), content(number, 24u + k, i));
            compare(in_array[i][k] == right, 120u + k, number, i);
        }
        if (MODE != 2u) compare(in_whole[i] == ivec2(content(number, 30u, i), -content(number, 31u, i)), 130u, number, i);
        vec3 direction = vec3(content(number, 32u, i), content(number, 33u, i), content(number, 34u, i));
        compare(in_corner[i].direction == direction, 135u, number, i);
        for (uint k = 0u; k < 2u; ++k) compare(in_corner[i].weights[k] == content(number, 35u + k, i), 136u, number, i);
        compare(gl_in[i].gl_Position == vec4(content(number, 40u, i), 0.5, -1.0, 1.0), 140u, number, i);
    }
    for (uint k = 0u; k < 3u; ++k) {
        vec4 right = vec4(content(number, 50u, k), content(number, 51u, k), content(number, 52u, k), content(number, 53u, k));
        compare(in_list[k] == right, 150u, number, k);
    }
    compare(in_pair.pair == vec2(content(number, 60u, 0u), content(number, 61u, 0u)), 160u, number, 0u);
    compare(in_pair.one == content(number, 62u, 0u), 161u, number, 0u);
    for (uint k = 0u; k < OUTERS; ++k) compare(gl_TessLevelOuter[k] == draw.outer[k], 170u, number, k);
    for (uint k = 0u; k < INNERS; ++k) compare(gl_TessLevelInner[k] == draw.inner[k], 180u, number, k);
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
