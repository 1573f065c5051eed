// Where control points live: in the scratch ring, where a control shader computes them and the evaluation shader of the same patch reads them; or in
// the cache of a pose, where `surface.comp` computes each once and all draws read it.
//
// In the ring, invocation 0 of a control shader takes a slot, all 32 fill it, and the barriers make it visible before the slot's place is written as a
// patch output. The evaluation shader reads the place first, then passes a barrier, then loads coherently. GLSL promises visibility to
// stages that the writer triggers (GLSL 4.60, section 7.10), the memory barrier and `coherent` make it available in Vulkan's terms
// (Vulkan spec, "Memory Model", availability and visibility).
#ifndef SCRATCH_GLSL
#define SCRATCH_GLSL

#include "lib/interface.glsl"

#ifdef CACHED_POINTS
#ifdef STAGE_COMPUTE
layout(set = SET_POSE, binding = BINDING_POINTS, scalar) buffer Cache { vec3 cached[]; };
#else
layout(set = SET_POSE, binding = BINDING_POINTS, scalar) readonly buffer Cache { vec3 cached[]; };
#endif

// Where the places of a patch's points begin.
uint slot_of(uint number) { return bases.own[TABLES + 1u] + words[bases.own[TABLES] + number]; }

// Among them, those of a use.
uint use_points(uint slot, uint number) { return bases.own[TABLES + 1u] + words[slot + number]; }

// What the points of a use are relative to where their plan says nothing else.
vec3 use_origin(uint slot, uint number) { return cached[words[slot + USES + number]]; }

// The point at a place.
vec3 point_at(uint place) { return cached[words[place]]; }
#else
layout(set = SET_FRAME, binding = BINDING_SCRATCH, scalar) coherent buffer Scratch { vec4 scratch[]; };
layout(set = SET_FRAME, binding = BINDING_COUNTERS, scalar) coherent buffer Counters { uint counters[]; };

const uint NO_SLOT = 0xffffffffu;

// As in a cache; here places are those in the ring.
uint use_points(uint slot, uint number) { return slot + uint(scratch[slot + number].w); }
vec3 use_origin(uint slot, uint number) { return scratch[slot + number].xyz; }
vec3 point_at(uint place) { return scratch[place].xyz; }

#ifdef STAGE_CONTROL
// The slot that what is drawn was given beforehand.
uint given_slot(uint number, uint view) {
    uint own = min(number, frame.end_patch - 1u);
    if (are_sub_patches()) return sub_patches[own].slot;
    return draws[((frame.flags & FRAME_DECIDED) != 0u ? view * bases.patches : 0u) + own].slot;
}

// A slot for `points` points of a patch, or NO_SLOT when the ring has no room: the patch is not drawn then, and the overflow is counted so
// that the host can draw again. A control shader may run more than once (Vulkan spec, "Tessellation Control Shader Execution"), so the sum
// of what is taken can exceed the sum of what is needed. Slots that are given do not depend on who runs when.
uint take_slot(uint number, uint view, uint points) {
    atomicAdd(counters[COUNTER_POINTS], points);
    bool is_given = (frame.flags & FRAME_GIVEN_SLOTS) != 0u;
    uint slot = is_given ? given_slot(number, view) : atomicAdd(counters[frame.counter], points);
    uint room = uint(scratch.length());
    if (points <= room && slot <= room - points) return slot;
    atomicAdd(counters[COUNTER_OVERFLOWS], 1u);
    return NO_SLOT;
}
#endif
#endif

#endif
