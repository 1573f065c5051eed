#version 460
#extension GL_GOOGLE_include_directive : require

// The form that our own scratch ring has: coherent memory and a barrier for buffers.
#define CONTROL_MEMORY coherent
#define EVALUATION_MEMORY coherent
#define MAKE_VISIBLE memoryBarrierBuffer()
#include "conformance/visibility_evaluation.glsl"
