// Gregory quads (Loop, Schaefer, Ni, Castano 2009). Twin of `method/gregory.rs`.
#ifndef GREGORY_QUADS_GLSL
#define GREGORY_QUADS_GLSL

const uint CORNERS = 4u;
#define CONTROL_VERTICES 20

#include "lib/gregory.glsl"
#include "lib/blended_quad.glsl"
#include "lib/quad.glsl"

#ifdef STAGE_EVALUATION
Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    Surface surface = blended_quad(uv);
    Spot spot = quad_spot(uv);
    return on_border(record, surface, spot.edge, spot.corner, spot.along);
}
#endif

#endif
