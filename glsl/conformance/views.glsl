// The number of a view, as each stage reads it.
#ifndef VIEWS_GLSL
#define VIEWS_GLSL

#extension GL_EXT_multiview : require
#extension GL_EXT_scalar_block_layout : require

const uint ALL = 0xffffffffu;
// The view that is drawn, where it is not one of several.
layout(constant_id = 0) const uint VIEW = ALL;
// A bit for each stage that reads the number: vertex, control, evaluation, fragment.
layout(constant_id = 1) const uint READERS = 15u;

// How often the evaluation shader ran in each view, if it reads the number.
layout(set = 0, binding = 0, scalar) buffer Runs { uint runs[]; };

layout(push_constant, scalar) uniform Draw { float level; };

// 0 in a stage that does not read it.
uint view_in(uint stage) {
    if ((READERS >> stage & 1u) == 0u) return 0u;
    return VIEW == ALL ? uint(gl_ViewIndex) : VIEW;
}

// The part of the colour that is a stage's: three bits.
uint part(uint stage) { return view_in(stage) << 3u * stage + 1u; }

#endif
