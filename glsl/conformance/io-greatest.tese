#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/io-greatest.glsl"

layout(quads, equal_spacing, ccw) in;

layout(location = 0) in vec4 in_values[][VALUES];
layout(location = 15) patch in vec4 in_lists[LISTS];
layout(location = 29) patch in uint in_patch;
in gl_PerVertex { vec4 gl_Position; } gl_in[gl_MaxPatchVertices];

void main() {
    uint number = in_patch;
    for (uint i = 0u; i < draw.vertices; ++i) {
        for (uint k = 0u; k < VALUES; ++k) compare(in_values[i][k] == values(number, 10u * k, i + draw.fault), 200u + k, number, i);
        compare(gl_in[i].gl_Position == values(number, 300u, i), 300u, number, i);
    }
    for (uint k = 0u; k < LISTS; ++k) compare(in_lists[k] == values(number, 400u, k), 400u, number, k);
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
