#version 460
#extension GL_GOOGLE_include_directive : require

#define PRIMITIVE lines
#define STRIP line_strip
#define VERTICES 2
#include "conformance/feedback.glsl"
