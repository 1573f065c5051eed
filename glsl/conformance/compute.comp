#version 460
#extension GL_GOOGLE_include_directive : require

#include "conformance/compute.glsl"

layout(local_size_x = 64) in;

void main() {
    uint place = gl_GlobalInvocationID.x;
    if (place < draw.count) words[place] = content(place, draw.round);
}
