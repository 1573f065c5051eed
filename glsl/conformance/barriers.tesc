#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/barriers.glsl"

// The host writes another number in the module.
layout(vertices = 32) out;

layout(location = 0) in uint in_vertex[];
layout(location = 0) patch out uint out_patch;
layout(location = 1) out uint out_word[];
layout(location = 2) patch out uint out_words[LOCATIONS];
// Components of one vector are different invocations'.
layout(location = 18) patch out uvec4 out_vectors[MOST / 4u];
out gl_PerVertex { vec4 gl_Position; } gl_out[];

uint number;

void write(uint place, uint word) {
    if (FORM == 0u) out_word[gl_InvocationID] = word;
    if (FORM == 1u) out_words[place] = word;
    if (FORM == 4u) out_vectors[place / 4u][place % 4u] = word;
    if (FORM == 2u) gl_out[gl_InvocationID].gl_Position = vec4(float(word), 0.0, 0.0, 1.0);
    if (FORM == 3u) words[number * MOST + place] = word;
}

uint read(uint place) {
    if (FORM == 0u) return out_word[place];
    if (FORM == 1u) return out_words[place];
    if (FORM == 4u) return out_vectors[place / 4u][place % 4u];
    if (FORM == 2u) return uint(gl_out[place].gl_Position.x);
    return words[number * MOST + place];
}

// `memoryBarrierBuffer` on both sides of `barrier` is for the buffer.
void main() {
    number = in_vertex[0] / POINTS;
    uint self = uint(gl_InvocationID);
    uint own = first_word(number, self);
    write(self, own);
    memoryBarrierBuffer();
    barrier();
    memoryBarrierBuffer();
    out_patch = number;

#define ROUND                                                  \
    {                                                          \
        uint left = read((self + INVOCATIONS - 1u) % INVOCATIONS); \
        uint right = read((self + 1u) % INVOCATIONS);          \
        own = next_word(own, left, right);                     \
    }                                                          \
    memoryBarrierBuffer();                                     \
    barrier();                                                 \
    memoryBarrierBuffer();                                     \
    write(self, own);                                          \
    memoryBarrierBuffer();                                     \
    barrier();                                                 \
    memoryBarrierBuffer();

    ROUND
    ROUND
    ROUND
    ROUND
    // What all of them read of one another decides on the levels: 2 where it is right.
    uint sum = 0u;
    for (uint place = 0u; place < INVOCATIONS; ++place) sum += read(place);
    for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = sum < INVOCATIONS * PRIME ? 2.0 : 1.0;
    for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = 2.0;
}
