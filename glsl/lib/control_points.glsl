// The control points of a patch as they are evaluated, when the method hands them on instead of using the scratch ring.
#ifndef CONTROL_POINTS_GLSL
#define CONTROL_POINTS_GLSL

#if defined(STAGE_EVALUATION) && !defined(WHOLE_PATCH)
layout(location = 2) in vec3 in_point[];
#endif

#endif
