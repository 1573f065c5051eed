#version 460
#extension GL_GOOGLE_include_directive : require

#define DISTANCES gl_ClipDistance
#include "conformance/distances.glsl"
