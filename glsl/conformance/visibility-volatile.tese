#version 460
#extension GL_GOOGLE_include_directive : require

// Volatile memory, which is coherent as well (GLSL 4.60, section 4.10).
#define CONTROL_MEMORY volatile
#define EVALUATION_MEMORY volatile
#define MAKE_VISIBLE memoryBarrierBuffer()
#include "conformance/visibility_evaluation.glsl"
