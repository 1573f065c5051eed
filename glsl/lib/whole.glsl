// A method with all that it does to a patch in one stage, for shells that do without control and evaluation shaders: the functions of these
// stages, and an array where they hand control points on.
#ifndef WHOLE_GLSL
#define WHOLE_GLSL

#define WHOLE_PATCH
#ifndef STAGE_VERTEX
#define STAGE_VERTEX
#endif
#define STAGE_CONTROL
#define STAGE_EVALUATION

#include "lib/interface.glsl"

// What the vertex shader hands to the control shader, then what that hands to the evaluation shader.
vec3 in_point[CONTROL_INVOCATIONS];

#include "method"

// Makes a patch ready for `evaluate_patch`.
void fit_patch(Patch record) {
    for (uint i = 0u; i < CONTROL_POINTS; ++i) in_point[i] = control_point(record, i);
    vec3 fitted[CONTROL_VERTICES];
    for (uint i = 0u; i < uint(CONTROL_VERTICES); ++i) fitted[i] = patch_point(record, i);
    for (uint i = 0u; i < uint(CONTROL_VERTICES); ++i) in_point[i] = fitted[i];
}

#endif
