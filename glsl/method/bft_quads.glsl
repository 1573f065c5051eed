// Tables of basis functions over quads: `bft.glsl` with the other domain. Twin of `method/bft.rs`.
#define QUADS

#include "method/bft.glsl"
