// Adaptive quadtrees for patches with long rings, of more than 32 vertices: `quadtree.glsl`, which fetches what the vertex shader has no room for.
// Twin of `method/quadtree/twin.rs`.
#define SCRATCH_RING
#define LONG_RINGS

#include "method/quadtree.glsl"
