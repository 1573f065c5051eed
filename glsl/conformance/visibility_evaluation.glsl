// The evaluation stage of every form: reads the slot's place first, then passes a barrier, then compares every word.
#include "conformance/visibility.glsl"

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_patch;
layout(location = 1) patch in uint in_slot;
layout(location = 0) flat out uint out_patch;

void main() {
    uint slot = in_slot;
    MAKE_VISIBLE;
    uint wrong = 0u;
    for (uint i = 0u; i < draw.words; ++i) {
        uint value = LOAD(slot + i);
        if (value == content(in_patch, i, draw.round + draw.fault)) continue;
        ++wrong;
        results.first_patch = in_patch;
        results.first_number = i;
        results.first_value = value;
    }
    atomicAdd(results.compared, draw.words);
    atomicAdd(results.wrong, wrong);
    out_patch = in_patch;
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
