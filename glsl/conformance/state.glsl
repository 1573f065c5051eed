// Draws of one submission, each into a cell of the picture, with shaders that count what comes of each.
#ifndef STATE_GLSL
#define STATE_GLSL

#extension GL_EXT_scalar_block_layout : require

// Control points of a patch; 0 where there are no patches.
layout(constant_id = 0) const uint POINTS = 0u;

// How often the last stage before the rasteriser ran in each draw, and how many control points a patch said that it had.
struct Count {
    uint runs;
    uint points;
};
layout(set = 0, binding = 0, scalar) buffer Counts { Count counts[]; };

// Twin of `state::Constants`.
layout(push_constant, scalar) uniform Draw {
    uint number;
    uint columns;
    float level;
} draw;

vec4 in_cell(vec2 place) {
    float side = 2.0 / float(draw.columns);
    vec2 cell = vec2(draw.number % draw.columns, draw.number / draw.columns);
    // Lines on a cell's border would be drawn in the next one.
    return vec4((cell + 0.125 + 0.75 * place) * side - 1.0, 0.0, 1.0);
}

#endif
