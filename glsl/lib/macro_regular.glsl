// A cell of a macro face that is one bicubic B-spline. Its control vertices are those that were handed on, or with FETCHED_GRID fetched one by one. Twin of
// `method/quadtree/macro_faces.rs`.
#ifndef MACRO_REGULAR_GLSL
#define MACRO_REGULAR_GLSL

#include "lib/macro_face.glsl"
#include "lib/ptex.glsl"

// See `grid_steps`, and where the grid begins.
ivec3 cell_steps;
uint grid_begin;

#ifdef FETCHED_GRID
#define GRID_POINT(i) control_vertex(control_at(grid_begin + i))
#else
#define GRID_POINT(i) in_point[i]
#endif

#define REGULAR_POINT(i) GRID_POINT(uint(cell_steps.x + (int(i) & 3) * cell_steps.y + (int(i) >> 2) * cell_steps.z))
#define REGULAR_PICK(turned, i, j) REGULAR_POINT(turned ? j : i)
#include "lib/regular.glsl"

Point regular_cell(Patch record, Patch cell, CellPlace place) {
    cell_steps = grid_steps(record, place);
    grid_begin = record.controls + MACRO_HEADER;
    return surface_point(regular_surface(cell, place.uv));
}

// What was evaluated has tangents by the cell's own patch; by those of the macro face nobody asks.
void keep_cell_tangents(Patch cell) {
    if (TANGENTS) to_ptex_tangents(cell, kept_du, kept_dv);
}

#endif
