// Columns and rows of a macro face (Brainerd et al. 2016, section 7.3).
#ifndef CELLS_GLSL
#define CELLS_GLSL

#include "abi.glsl"

uvec2 cells_of(Patch record) {
    return (uvec2(record.flags >> MACRO_COLUMNS_SHIFT, record.flags >> MACRO_ROWS_SHIFT) & 31u) + 1u;
}

#endif
