// What macro faces of regular faces alone have in common. Twin of `method/quadtree/macro_faces.rs`.
#ifndef MACRO_PLAIN_GLSL
#define MACRO_PLAIN_GLSL

#ifdef STAGE_EVALUATION
#include "lib/macro_regular.glsl"

bool has_one_normal(Patch record, vec2 uv) { return true; }

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    CellPlace place = find_cell(record, uv);
    Patch cell = patches[place.number];
    Point point = regular_cell(record, cell, place);
    keep_cell_tangents(cell);
    return point;
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) { return Cell(NODE_REGULAR, find_cell(record, uv).uv, 1.0); }
#endif

#endif
