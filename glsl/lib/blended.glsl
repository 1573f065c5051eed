// Points inside of Gregory patches (Loop, Schaefer, Ni, Castano 2009). Twin of `method/blended.rs`.
#ifndef BLENDED_GLSL
#define BLENDED_GLSL

#ifdef STAGE_EVALUATION
// A mean of two inner points that differ, whose weights vanish together at a corner: there it counts for nothing.
struct Blended {
    vec3 mean;
    // By b times this the mean changes with a, and by -a times this with b.
    vec3 change;
};

Blended blended(float a, float b, vec3 before, vec3 behind) {
    precise float whole = max(a + b, 1e-9);
    precise vec3 mean = (a * before + b * behind) / whole;
    precise vec3 change = (before - behind) / (whole * whole);
    return Blended(mean, change);
}
#endif

#endif
