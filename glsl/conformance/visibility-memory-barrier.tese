#version 460
#extension GL_GOOGLE_include_directive : require

// Coherent memory and a barrier for memory of every kind.
#define CONTROL_MEMORY coherent
#define EVALUATION_MEMORY coherent
#define MAKE_VISIBLE memoryBarrier()
#include "conformance/visibility_evaluation.glsl"
