// As many outputs as every device has: 60 components a vertex beside its position, and 30 locations.
#ifndef IO_GREATEST_GLSL
#define IO_GREATEST_GLSL

#include "conformance/io.glsl"

const uint VALUES = 15u;
const uint LISTS = 14u;

vec4 values(uint number, uint what, uint place) {
    return vec4(content(number, what, place), content(number, what + 1u, place), content(number, what + 2u, place), content(number, what + 3u, place));
}

#endif
