#version 460
#extension GL_GOOGLE_include_directive : require

// Each stage says that it only writes, or only reads.
#define CONTROL_MEMORY coherent writeonly
#define EVALUATION_MEMORY coherent readonly
#define MAKE_VISIBLE memoryBarrierBuffer()
#include "conformance/visibility_control.glsl"
