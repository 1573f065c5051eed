#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/barriers.glsl"

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_patch;
layout(location = 1) in uint in_word[];
layout(location = 2) patch in uint in_words[LOCATIONS];
layout(location = 18) patch in uvec4 in_vectors[MOST / 4u];
in gl_PerVertex { vec4 gl_Position; } gl_in[gl_MaxPatchVertices];

void main() {
    uint number = in_patch;
    memoryBarrierBuffer();
    uint right[MOST];
    uint next[MOST];
    for (uint i = 0u; i < INVOCATIONS; ++i) right[i] = first_word(number, i);
    for (uint round = 0u; round < ROUNDS; ++round) {
        for (uint i = 0u; i < INVOCATIONS; ++i) next[i] = next_word(right[i], right[(i + INVOCATIONS - 1u) % INVOCATIONS], right[(i + 1u) % INVOCATIONS]);
        for (uint i = 0u; i < INVOCATIONS; ++i) right[i] = next[i];
    }
    for (uint i = 0u; i < INVOCATIONS; ++i) {
        uint found = 0u;
        if (FORM == 0u) found = in_word[i];
        if (FORM == 1u) found = in_words[i];
        if (FORM == 4u) found = in_vectors[i / 4u][i % 4u];
        if (FORM == 2u) found = uint(gl_in[i].gl_Position.x);
        if (FORM == 3u) found = words[number * MOST + i];
        atomicAdd(results.compared, 1u);
        if (found != right[i] + fault) {
            atomicAdd(results.wrong, 1u);
            results.first_patch = number;
            results.first_place = i;
            results.first_word = found;
        }
    }
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
