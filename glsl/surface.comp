#version 460
#extension GL_GOOGLE_include_directive : require

// Control points into the cache of a pose, one an invocation: what control shaders compute for the ring, with the same bits.
//
// Patches stand for jobs here, from `first_patch` to `end_patch`; `counter` is the first one's point.

#define CACHED_POINTS

#include "lib/interface.glsl"
#include "method"

layout(local_size_x = CONTROL_INVOCATIONS) in;

layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer JobTable { uvec2 jobs[]; };

void main() {
    uint number = frame.first_patch + gl_GlobalInvocationID.x;
    if (number >= frame.end_patch) return;
    cached[frame.counter + gl_GlobalInvocationID.x] = job_point(jobs[bases.own[TABLES + 2u] + number]);
}
