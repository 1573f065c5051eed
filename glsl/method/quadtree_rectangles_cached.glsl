// Rectangles of faces whose control points are in a pose's cache: `quadtree_rectangles.glsl` without its control shader.
// Twin of `method/quadtree/macro_faces.rs`.
#define CACHED_POINTS

#include "method/quadtree_rectangles.glsl"
