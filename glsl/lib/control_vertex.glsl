// Where a control vertex is. The only place that reads positions: an engine that skins or morphs its control mesh puts its own here.
#ifndef CONTROL_VERTEX_GLSL
#define CONTROL_VERTEX_GLSL

#include "lib/interface.glsl"

vec3 control_vertex(uint number) { return positions[number]; }

#endif
