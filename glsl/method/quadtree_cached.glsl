// Adaptive quadtrees whose control points are in a pose's cache: `quadtree.glsl` without its control shader. Twin of `method/quadtree/twin.rs`.
#define CACHED_POINTS

#include "method/quadtree.glsl"
