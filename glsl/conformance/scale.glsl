// What the control and evaluation stages note of each patch.
#ifndef SCALE_GLSL
#define SCALE_GLSL

#extension GL_EXT_scalar_block_layout : require

// Twin of `scale::Note`. `high` and `low` are the greatest of gl_PrimitiveID + 1 and of its complement: both start at zero, and the least and
// the greatest number seen follow from them.
struct Note {
    uint controls;
    uint control_high;
    uint control_low;
    uint evaluations;
    uint evaluation_high;
    uint evaluation_low;
    uint bad_points;
};
layout(set = 0, binding = 0, scalar) buffer Notes { Note notes[]; };

// Twin of `scale::Constants`.
layout(push_constant, scalar) uniform Draw {
    // Patches an instance.
    uint per_instance;
    // All patches.
    uint patches;
    // The vertex and the instance that the draw begins with.
    uint first_vertex;
    uint first_instance;
    // Cells of the picture in a row; in each a patch is seen.
    uint columns;
    // A cell's side in clip space.
    float side;
    float level;
} draw;

#endif
