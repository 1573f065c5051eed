// The control stage of every form. The host rewrites the number of invocations, and tells it by the constant.
#include "conformance/visibility.glsl"

layout(constant_id = 0) const uint INVOCATIONS = 32u;

layout(vertices = 32) out;

layout(location = 0) in uint in_vertex[];
layout(location = 1) in uint in_instance[];
layout(location = 0) patch out uint out_patch;
layout(location = 1) patch out uint out_slot;

uint take_slot(uint number) {
    uint slot = draw.host != 0u ? (number - draw.first_patch) * draw.words : atomicAdd(taken[draw.counter], draw.words);
    if (slot + draw.words <= draw.room) return slot;
    atomicAdd(results.refused, 1u);
    return NO_SLOT;
}

void main() {
    uint number = draw.first_patch + in_vertex[0];
    if (gl_InvocationID == 0) out_slot = take_slot(number);
    barrier();
    uint slot = out_slot;
    uint count = slot == NO_SLOT ? 0u : draw.words;
    for (uint i = gl_InvocationID; i < count; i += INVOCATIONS) STORE(slot + i, content(number, i, draw.round));
    MAKE_VISIBLE;
    BARRIER;
    MAKE_VISIBLE;
    if (gl_InvocationID == 0) {
        out_patch = number;
        float level = slot == NO_SLOT ? 0.0 : draw.level;
        for (uint i = 0u; i < 4u; ++i) gl_TessLevelOuter[i] = level;
        for (uint i = 0u; i < 2u; ++i) gl_TessLevelInner[i] = level;
    }
}
