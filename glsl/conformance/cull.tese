#version 460
#extension GL_GOOGLE_include_directive : require

#define DISTANCES gl_CullDistance
#include "conformance/distances.glsl"
