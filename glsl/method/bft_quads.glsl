// Tables of basis functions over quads: `bft.glsl` with the other domain.
#define QUADS

#include "method/bft.glsl"
