#version 460
#extension GL_GOOGLE_include_directive : require

// Both qualifiers.
#define CONTROL_MEMORY volatile coherent
#define EVALUATION_MEMORY volatile coherent
#define MAKE_VISIBLE memoryBarrierBuffer()
#include "conformance/visibility_evaluation.glsl"
