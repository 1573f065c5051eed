// Points that `points.comp` or the host computed from the control vertices.
#ifndef POINTS_GLSL
#define POINTS_GLSL

#include "lib/interface.glsl"

layout(set = SET_POSE, binding = BINDING_POINTS, scalar) readonly buffer PointTable { Point points[]; };

// The point that is a patch's control point of this number.
Point patch_control(Patch record, uint number) { return points[control_at(record.controls + number)]; }

#endif
