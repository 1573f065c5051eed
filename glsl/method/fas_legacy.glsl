// The same, whose points are sums that each patch makes for itself in each frame. Twin of `method/fas.rs`.
#ifndef FAS_LEGACY_GLSL
#define FAS_LEGACY_GLSL

#define SUMS_POINTS

#include "method/fas_gregory.glsl"

#ifdef STAGE_CONTROL
// Where the terms of each point begin and end is told first, counted from there.
vec3 patch_point(Patch record, uint number) {
    uint first = record.controls + control_at(record.controls + number);
    uint end = record.controls + control_at(record.controls + number + 1u);
    precise vec3 sum = vec3(0.0);
    for (uint i = first; i < end; i += 2u) sum = sum + uintBitsToFloat(control_at(i + 1u)) * points[control_at(i)].position;
    return sum;
}
#endif

#endif
