// B-spline patches of dynamic feature-adaptive subdivision (Schäfer et al. 2015): those of `fas`, of which a frame draws some. Twin of `method/dfas.rs`.
#ifndef DFAS_GLSL
#define DFAS_GLSL

#include "method/fas.glsl"

#endif
