#version 460
#extension GL_GOOGLE_include_directive : require

// Coherent memory that no other variable of the stage points to.
#define CONTROL_MEMORY coherent restrict
#define EVALUATION_MEMORY coherent restrict
#define MAKE_VISIBLE memoryBarrierBuffer()
#include "conformance/visibility_evaluation.glsl"
