// Several faces as one patch (Brainerd et al. 2016, section 7.3). Twin of `method/quadtree/macro_faces.rs`, where it is told why places are exact.
#ifndef MACRO_FACE_GLSL
#define MACRO_FACE_GLSL

#include "lib/cells.glsl"
#include "lib/interface.glsl"

// The slot of the first cell, whose patches stand there one after another.
uint first_cell(Patch record) { return control_at(record.controls); }

// Which cell has a point, and where in the face's own patch.
struct CellPlace {
    uint number;
    // Column and row.
    uvec2 at;
    // How many cells with plans are before it.
    uint before;
    uint turn;
    vec2 uv;
};

CellPlace find_cell(Patch record, vec2 uv) {
    uvec2 cells = cells_of(record);
    precise vec2 whole = uv * vec2(cells);
    precise vec2 nearest = roundEven(whole * float(MACRO_STEPS));
    uvec2 steps = uvec2(nearest);
    uvec2 at = min(steps / MACRO_STEPS, cells - 1u);
    precise vec2 own = vec2(steps - at * MACRO_STEPS) * (1.0 / float(MACRO_STEPS));
    // Where a side is one cell its vertices are exact, and beside an n-gon they are at half steps.
    own = mix(own, uv, equal(cells, uvec2(1u)));
    precise vec2 rest = 1.0 - own;
    uint number = at.x + cells.x * at.y;
    uint word = control_at(record.controls + MACRO_HEADER + (cells.x + 3u) * (cells.y + 3u) + number);
    uint turn = word >> MACRO_TURN_SHIFT & 3u;
    vec2 turned = turn == 0u ? own : turn == 1u ? vec2(rest.y, own.x) : turn == 2u ? rest : vec2(own.y, rest.x);
    return CellPlace(first_cell(record) + number, at, word & 0xffffu, turn, turned);
}

// What a pixel covers of a cell in the face's own patch, from what it covers of the macro face.
vec2 cell_pixel(Patch record, vec2 uv, vec2 pixel) {
    vec2 finer = pixel * vec2(cells_of(record));
    return (find_cell(record, uv).turn & 1u) != 0u ? finer.yx : finer;
}

// Whether a cell is evaluated by a plan: it has a ring.
bool has_plan(Patch cell) { return (cell.flags >> PATCH_RING_SHIFT & 63u) != 0u; }

// The place in the grid where control vertex (0, 0) of a regular face is, and how far it is from there to the next along its u and v.
ivec3 grid_steps(Patch record, CellPlace place) {
    int pitch = int(cells_of(record).x) + 3;
    int origin = int(place.at.x) + pitch * int(place.at.y);
    if (place.turn == 0u) return ivec3(origin, 1, pitch);
    if (place.turn == 1u) return ivec3(origin + 3 * pitch, -pitch, 1);
    if (place.turn == 2u) return ivec3(origin + 3 + 3 * pitch, -1, -pitch);
    return ivec3(origin + 3, pitch, -1);
}

// Of whole levels over all cells, as the tessellator has them, those of each cell.
Levels cell_levels(Patch record, Levels levels) {
    uvec2 cells = cells_of(record);
    return Levels(vec4(uvec4(levels.edges) / cells.xyxy), float(uint(levels.inside) / cells.x));
}

// A vertex of a side with so many cells of so many segments, counted, where it is over all of them.
float side_place(float t, uint cells, uint segments, bool halves, float one_over_cells) {
    uint count = cells * segments;
    precise float near = t * float(count) + 0.5;
    uint i = min(uint(near), count);
    uint cell = min(i / segments, cells - 1u);
    uint k = i - cell * segments;
    // Beside an n-gon as two edges.
    uint part = halves ? segments / 2u : segments;
    bool second = halves && k > part;
    precise float along = step_of(second ? k - part : k, part);
    if (halves) along = second ? 0.5 + 0.5 * along : 0.5 * along;
    precise float place = (float(cell) + along) * one_over_cells;
    return i == count ? 1.0 : place;
}

// A level of 1 inside is just over 1, which is two segments, where there are more cells the other way.
uint inside_segments(float level, uint cells) { return max(uint(level), cells == 1u ? 2u : 1u); }

vec2 shared_coordinates(Patch record, Levels levels, vec3 coordinates) {
    uvec2 cells = cells_of(record);
    vec2 uv = coordinates.xy;
    bvec2 on = bvec2(uv.x <= 0.0 || uv.x >= 1.0, uv.y <= 0.0 || uv.y >= 1.0);
    if (on.x && on.y) return uv;
    uint edge = on.y ? (uv.y <= 0.0 ? 0u : 2u) : (uv.x <= 0.0 ? 3u : 1u);
    bool halves = (on.x || on.y) && (record.flags & (PATCH_EVEN_EDGE << edge)) != 0u;
    uint along_edge = uint(levels.edges[edge]);
    uint u = on.y ? along_edge : inside_segments(levels.inside, cells.x);
    uint v = on.x ? along_edge : inside_segments(levels.inside, cells.y);
    vec2 one_over = vec2(uintBitsToFloat(control_at(record.controls + 1u)), uintBitsToFloat(control_at(record.controls + 2u)));
    return vec2(on.x ? uv.x : side_place(uv.x, cells.x, u, halves, one_over.x),
                on.y ? uv.y : side_place(uv.y, cells.y, v, halves, one_over.y));
}

#endif
