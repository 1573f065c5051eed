#version 460
#extension GL_GOOGLE_include_directive : require

#define PRIMITIVE triangles
#define STRIP triangle_strip
#define VERTICES 3
#include "conformance/feedback.glsl"
