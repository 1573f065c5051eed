// What an instance of a draw is. A draw has all its patches in one view after the other.
#ifndef INSTANCES_GLSL
#define INSTANCES_GLSL

#include "lib/interface.glsl"

// The view that the instance belongs to.
uint instance_view() { return frame.view + uint(gl_InstanceIndex) / frame.instances; }

// Which of that view's instances it is.
uint instance_part() { return uint(gl_InstanceIndex) % frame.instances; }

#endif
