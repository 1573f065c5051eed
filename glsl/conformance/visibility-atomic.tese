#version 460
#extension GL_GOOGLE_include_directive : require

// Atomic operations, which are coherent whatever the memory is; the barrier orders them.
#define CONTROL_MEMORY coherent
#define EVALUATION_MEMORY coherent
#define MAKE_VISIBLE memoryBarrierBuffer()
#define STORE(at, value) atomicExchange(words[at], value)
#define LOAD(at) atomicOr(words[at], 0u)
#include "conformance/visibility_evaluation.glsl"
