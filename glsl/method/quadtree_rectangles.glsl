// Rectangles of faces as one patch (Brainerd et al. 2016, section 7.3, figure 7): regular cells by a grid of control vertices, others by their plans, as
// `quadtree.glsl` has them for faces. Twin of `method/quadtree/macro_faces.rs`.
//
// A macro face's slot in the ring begins with a word for each cell that has a plan: where in it that cell's slot begins.
#ifndef QUADTREE_RECTANGLES_GLSL
#define QUADTREE_RECTANGLES_GLSL

#ifndef CACHED_POINTS
#define SCRATCH_RING
#endif
#define MACRO_FACES
// Rings are of several faces: the vertex shader has no room for them.
#define FETCHED_RINGS

// What a patch of its own has, a cell has by another name.
#define CONTROL_POINTS PLANNED_CONTROL_POINTS
#define control_point planned_control_point
#define evaluate_patch planned_patch
#define has_one_normal planned_has_one_normal
#define cell_at planned_cell_at
#define scratch_points planned_points
#define run_stencils run_planned_stencils
#include "method/quadtree.glsl"
#undef CONTROL_POINTS
#undef control_point
#undef evaluate_patch
#undef has_one_normal
#undef cell_at
#undef scratch_points
#undef run_stencils

const uint CONTROL_POINTS = 1u;

#ifdef STAGE_VERTEX
vec3 control_point(Patch record, uint number) { return vec3(0.0); }
#endif

#if defined(STAGE_CONTROL) && !defined(CACHED_POINTS)
uint planned_cells(Patch record) { return control_at(record.controls + 3u); }

// A cell with a plan, of those there are.
Patch planned_cell(Patch record, uint i) {
    uvec2 cells = cells_of(record);
    uint list = MACRO_HEADER + (cells.x + 3u) * (cells.y + 3u) + cells.x * cells.y;
    return patches[control_at(record.controls + list + i)];
}

uint scratch_points(Patch record, uint level) {
    uint count = planned_cells(record);
    uint points = count;
    for (uint i = 0u; i < count; ++i) points += planned_points(planned_cell(record, i), level);
    return points;
}

// All invocations go from cell to cell together.
void run_stencils(Patch record, uint slot, uint level, uint count) {
    uint cells = planned_cells(record);
    uint begin = cells;
    for (uint i = 0u; i < cells; ++i) {
        Patch cell = planned_cell(record, i);
        uint points = planned_points(cell, level);
        if (gl_InvocationID == 0 && count > 0u) scratch[slot + i].x = float(begin);
        run_planned_stencils(cell, slot + begin, level, count > 0u ? points : 0u);
        begin += points;
    }
}
#endif

#ifdef STAGE_EVALUATION
#define FETCHED_GRID
#include "lib/macro_regular.glsl"

bool has_one_normal(Patch record, vec2 uv) {
    CellPlace place = find_cell(record, uv);
    Patch cell = patches[place.number];
    return !has_plan(cell) || planned_has_one_normal(cell, place.uv);
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
    CellPlace place = find_cell(record, uv);
    Patch cell = patches[place.number];
    Point point;
    if (has_plan(cell)) {
#ifdef CACHED_POINTS
        uint own = slot_of(place.number);
#else
        memoryBarrierBuffer();
        uint own = slot + uint(scratch[slot + place.before].x);
#endif
        point = planned_patch(cell, own, place.uv);
    } else {
        point = regular_cell(record, cell, place);
    }
    keep_cell_tangents(cell);
    return point;
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) {
    CellPlace place = find_cell(record, uv);
    Patch cell = patches[place.number];
    return has_plan(cell) ? planned_cell_at(cell, place.uv) : Cell(NODE_REGULAR, place.uv, 1.0);
}
#endif

#endif
