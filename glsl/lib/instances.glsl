// What an instance of a draw is. A draw has all its patches in one view after the other; with multiview, in that of the first eye of each instance.
#ifndef INSTANCES_GLSL
#define INSTANCES_GLSL

#include "lib/interface.glsl"

// The view that the instance belongs to.
uint instance_view() {
    uint eyes = frame.flags >> FRAME_EYES_SHIFT & 63u;
    return frame.view + uint(gl_InstanceIndex) / frame.instances * eyes;
}

// Which of that view's instances it is.
uint instance_part() { return uint(gl_InstanceIndex) % frame.instances; }

#endif
