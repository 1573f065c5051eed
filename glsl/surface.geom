#version 460
#extension GL_GOOGLE_include_directive : require

// A row of a patch's triangles an invocation (Boubekeur, Schlick 2007, section 3.2): the same triangles as its refinement pattern has. What
// every device can put out, 1024 components, is 68 vertices of ours; the longest row has 66. With tangents it is 48, and there are half as many rows.
#extension GL_EXT_scalar_block_layout : require
#include "abi.glsl"
#ifdef WITH_TANGENTS
#define LATTICE_ROWS TANGENT_ROWS
#else
#define LATTICE_ROWS GEOMETRY_ROWS
#endif

// Whatever else the block has by itself would count among the components.
out gl_PerVertex { vec4 gl_Position; };

#include "lib/whole.glsl"
#include "lib/vertex.glsl"

layout(points, invocations = LATTICE_ROWS) in;
layout(triangle_strip, max_vertices = 2 * LATTICE_ROWS + 2) out;

layout(location = 0) flat in uint in_patch[];
layout(location = 1) flat in uint in_view[];

uint along(uint at, uint segments, float level) {
    uint steps = segments / uint(level);
    return (at + steps / 2u) / steps * steps;
}

// On edges that are counted from their end.
uint against(uint at, uint segments, float level) {
    uint steps = segments / uint(level);
    return (at + (steps - 1u) / 2u) / steps * steps;
}

// Where a point of the lattice goes: on an edge to the nearest point that the edge has. Twin of `snapped` in `tessellation/pattern.rs`.
uvec2 snapped(Levels levels, uint n, uvec2 at) {
    if (at.y == 0u) return uvec2(along(at.x, n, levels.edges[0]), 0u);
#ifdef TRIANGLES
    uint j = along(at.y, n, levels.edges[1]);
    if (at.x + at.y == n) return uvec2(n - j, j);
    if (at.x == 0u) return uvec2(0u, against(at.y, n, levels.edges[2]));
#else
    if (at.x == n) return uvec2(n, along(at.y, n, levels.edges[1]));
    if (at.y == n) return uvec2(against(at.x, n, levels.edges[2]), n);
    if (at.x == 0u) return uvec2(0u, against(at.y, n, levels.edges[3]));
#endif
    return at;
}

void emit(Patch record, Levels levels, uint n, uvec2 at) {
    vec2 uv = lattice_uv(snapped(levels, n, at), n);
    write_vertex(record, in_patch[0], in_view[0], uv, evaluate_patch(record, slot_of(in_patch[0]), uv));
    EmitVertex();
}

void main() {
    Patch record = patch_record(in_patch[0]);
    Levels levels = patch_levels(in_patch[0], in_view[0], record);
    uint n = uint(greatest_level(levels));
    uint row = uint(gl_InvocationID);
    if (row >= n) return;
    fit_patch(record);
    if (TANGENTS) tangent_level = required_level(levels);
    // From the end to the begin, so that triangles are counter-clockwise in (u, v).
#ifdef TRIANGLES
    uint end = n - row;
    emit(record, levels, n, uvec2(end, row));
    for (uint i = end; i-- > 0u;) {
        emit(record, levels, n, uvec2(i, row + 1u));
        emit(record, levels, n, uvec2(i, row));
    }
#else
    for (uint i = n + 1u; i-- > 0u;) {
        emit(record, levels, n, uvec2(i, row));
        emit(record, levels, n, uvec2(i, row + 1u));
    }
#endif
    EndPrimitive();
}
