// Which piece of a method's patch a point belongs to, for pictures that show it.
#ifndef CELL_GLSL
#define CELL_GLSL

#include "abi.glsl"

struct Cell {
    // NODE_...
    uint kind;
    // Where in the cell.
    vec2 uv;
    // How much faster `uv` runs than the patch's own.
    float scale;
};

#endif
