// Tess levels of a patch, a function of its edges alone on each edge. Twin of `tessellation/levels.rs`.
#ifndef LEVELS_GLSL
#define LEVELS_GLSL

#include "lib/half_level.glsl"
#include "lib/interface.glsl"

// Levels of the edges from corner i to corner i + 1, and of the inside.
struct Levels {
    vec4 edges;
    float inside;
};

// The levels that the host gives the patch, or the device in this view; or else those of a patch whose quad has the frame's level.
//
// Where a quad meets an n-gon, its edge gets twice the segments of the n-gon's half edge, so that both have a vertex in the middle and all
// vertices line up: 2k and k with equal spacing, 4k and 2k with fractional-even (Brainerd et al. 2016, section 7.2).
Levels patch_levels(uint number, uint view, Patch record) {
    if ((frame.flags & (FRAME_ADAPTIVE | FRAME_DECIDED)) != 0u) {
        uint first = (frame.flags & FRAME_DECIDED) != 0u ? view * bases.patches : 0u;
        PatchDraw draw = draws[first + min(number, frame.end_patch - 1u)];
        return Levels(draw.edges, draw.inside);
    }
    if ((record.flags & PATCH_VACANT) != 0u) return Levels(vec4(0.0), 0.0);
    float level = clamp(frame.level, 1.0, 64.0);
#ifdef PIECES
    bool fractional_even = (frame.flags & FRAME_FRACTIONAL_EVEN) != 0u;
    level = halved_level(level, patch_halvings(record), fractional_even);
    precise vec4 of_edges = vec4(level);
    precise float of_two = 2.0 * half_level(level, fractional_even);
    for (uint i = 0u; i < 4u; ++i) of_edges[i] = (record.flags & (PATCH_EVEN_EDGE << i)) != 0u ? of_two : level;
    return Levels(of_edges, level);
#else
    precise float halved = half_level(level, (frame.flags & FRAME_FRACTIONAL_EVEN) != 0u);
    if ((record.flags & PATCH_HALF) != 0u) return Levels(vec4(halved), halved);
    precise vec4 edges;
    for (uint i = 0u; i < 4u; ++i) {
        bool even = (record.flags & (PATCH_EVEN_EDGE << i)) != 0u;
        edges[i] = even ? 2.0 * halved : level;
    }
    return Levels(edges, level);
#endif
}

float greatest_level(Levels levels) {
    return max(levels.inside, max(max(levels.edges.x, levels.edges.y), max(levels.edges.z, levels.edges.w)));
}

// The level that stencils are needed for: ceil(log2 of the greatest factor).
uint required_level(Levels levels) {
    float greatest = greatest_level(levels);
    uint level = 0u;
    while (level < HIGHEST_LEVEL && float(1u << level) < greatest) ++level;
    return level;
}

// Vertex i of n on an edge, in steps of 2^-16; the steps from the other end are the same. Products with powers of two are exact, quotients
// need not be (Vulkan spec, "Precision of Individual Operations").
float step_of(uint i, uint n) {
    precise float t = float((i * 65536u + n / 2u) / n) * (1.0 / 65536.0);
    return t;
}

#ifdef TRIANGLES
// (u, v) of a triangle's point, from its barycentric coordinates: corner 0 is (0, 0), 1 is (1, 0), 2 is (0, 1). On edges they are whole steps
// of 2^-16, as tessellators count: so 1 - t is exact, and both sides of an edge have the same pair. Where quads may be on the other side,
// of which tessellators need not count in the same way, both count vertices.
vec2 shared_coordinates(Patch record, Levels levels, vec3 barycentric) {
    vec2 uv = barycentric.yz;
    if (min(barycentric.x, min(uv.x, uv.y)) > 0.0) return uv;
    uint edge = uv.y <= 0.0 ? 0u : barycentric.x <= 0.0 ? 1u : 2u;
    precise float along = edge == 0u ? uv.x : uv.y;
    precise float t = roundEven(along * 65536.0) * (1.0 / 65536.0);
    if ((record.flags & PATCH_REFINED) != 0u) {
        uint segments = uint(levels.edges[edge]);
        precise float steps = along * float(segments) + 0.5;
        t = step_of(uint(steps), segments);
    }
    precise float rest = 1.0 - t;
    if (edge == 0u) return vec2(t, uv.y);
    return vec2(edge == 1u ? rest : uv.x, t);
}
#elif defined(MACRO_FACES)
#include "lib/macro_face.glsl"
#else
// Of an edge beside an n-gon both sides must have the same coordinates, but what the tessellator makes of a quad's 1/6 may differ from half
// of what it makes of an n-gon's 1/3. Both count vertices, and take an edge's halves from `step_of`.
vec2 shared_coordinates(Patch record, Levels levels, vec3 coordinates) {
    vec2 uv = coordinates.xy;
    bvec2 on = bvec2(uv.x <= 0.0 || uv.x >= 1.0, uv.y <= 0.0 || uv.y >= 1.0);
    uint edge = on.y ? (uv.y <= 0.0 ? 0u : 2u) : (uv.x <= 0.0 ? 3u : 1u);
#ifdef PIECES
    // Levels that were halved are whole numbers.
    bool part = (record.flags & (PATCH_EVEN_EDGE << edge)) == 0u;
    bool beside = !part || patch_halvings(record) > 0u;
#else
    bool part = (record.flags & PATCH_HALF) != 0u;
    bool refined = (record.flags & PATCH_REFINED) != 0u;
    bool beside = part ? refined || edge == 0u || edge == 3u : (record.flags & (PATCH_EVEN_EDGE << edge)) != 0u;
#endif
#ifdef COUNTED_EDGES
    // A macro face beyond counts the vertices of all of its faces.
    if (!part && !beside && (record.flags & PATCH_COUNTED) != 0u) {
        part = true;
        beside = true;
    }
#endif
    if (on.x == on.y || !beside) return uv;
    float along = on.y ? uv.x : uv.y;
    uint segments = uint(ceil(levels.edges[edge]));
    uint half_segments = part ? segments : segments / 2u;
    precise float steps = along * float(segments) + 0.5;
    uint i = uint(steps);
    bool second = i > half_segments;
    precise float t = step_of(second ? i - half_segments : i, half_segments);
    if (!part) t = second ? 0.5 + 0.5 * t : 0.5 * t;
    return on.y ? vec2(t, uv.y) : vec2(uv.x, t);
}
#endif

#endif
