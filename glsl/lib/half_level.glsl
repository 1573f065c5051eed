// The level of half an edge beside an n-gon, see `patch_levels`. Twin of `half` in `tessellation/levels.rs`.
#ifndef HALF_LEVEL_GLSL
#define HALF_LEVEL_GLSL

float half_level(float level, bool fractional_even) {
    precise float halved = fractional_even ? 2.0 * ceil(level * 0.25) : ceil(level * 0.5);
    return halved;
}

#endif
