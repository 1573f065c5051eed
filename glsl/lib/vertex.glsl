// What becomes of a point of a patch, in whichever stage patches are evaluated: the fragment shader gets it, and it is recorded.
#ifndef VERTEX_GLSL
#define VERTEX_GLSL

#include "lib/displacement.glsl"
#include "lib/interface.glsl"
#include "lib/ptex.glsl"

// Pipelines that evaluate with these functions and differ in their fragment shaders or targets draw the same depths: a pre-pass may be
// compared with EQUAL (GLSL 4.60, section 4.8.1; SPIR-V, Invariant).
invariant gl_Position;

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_uv;
layout(location = 3) out vec2 out_texture;
layout(location = 4) flat out uint out_drawn;
// dP/du and dP/dv in the ptex face, for fragment shaders that ask for them; undefined for others.
#if !defined(STAGE_GEOMETRY) || defined(WITH_TANGENTS)
#define TANGENT_OUTPUTS
layout(location = 5) out vec3 out_du;
layout(location = 6) out vec3 out_dv;
#endif

layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer TextureTable { vec2 texture_corners[]; };

layout(set = SET_FRAME, binding = BINDING_CAPTURE, scalar) buffer Capture {
    uint captured_count;
    Captured captured[];
};

// Records the vertex; vertices beyond the capture's end are counted all the same.
void capture(uint number, vec2 uv, Point point) {
    uint place = atomicAdd(captured_count, 1u);
    if (place < uint(captured.length())) captured[place] = Captured(number, uv, point.position, point.normal);
}

// Linear between the patch's corners. Twin of `Pass::texture_coordinates`.
vec2 texture_coordinates(uint number, vec2 uv) {
#ifdef MACRO_FACES
    CellPlace place = find_cell(patch_record(number), uv);
    number = place.number;
    uv = place.uv;
#endif
    uint first = bases.texture + 4u * number;
    vec2 a = texture_corners[first];
    vec2 b = texture_corners[first + 1u];
    vec2 c = texture_corners[first + 2u];
#ifdef TRIANGLES
    return (1.0 - uv.x - uv.y) * a + uv.x * b + uv.y * c;
#else
    return mix(mix(a, b, uv.x), mix(texture_corners[first + 3u], c, uv.x), uv.y);
#endif
}

#ifndef CACHED_POINTS
// Methods without a cache have no slots there.
uint slot_of(uint number) { return 0u; }
#endif

void write_vertex(Patch record, uint number, uint view, vec2 uv, Point point) {
    vec2 displacement = views[view].displacement;
    bool displaced = displacement.x != 0.0 && has_one_normal(record, uv);
#ifdef TANGENT_OUTPUTS
    if (TANGENTS) {
        out_du = kept_du;
        out_dv = kept_dv;
#ifndef MACRO_FACES
        to_ptex_tangents(record, out_du, out_dv);
#endif
        if (displaced) displace_tangents(displacement, point.position, point.normal, out_du, out_dv);
    }
#endif
    if (displaced) displace(displacement, point.position, point.normal);
    out_position = point.position;
    out_normal = point.normal;
    out_uv = uv;
    out_texture = texture_coordinates(number, uv);
    out_drawn = drawn_key(number, view);
    gl_Position = views[view].clip_from_model * vec4(point.position, 1.0);
    if ((frame.flags & FRAME_PARITY) != 0u) gl_Position = amplified(gl_Position, point.position);
    if ((frame.flags & FRAME_CAPTURE) != 0u) capture(number, uv, point);
    if ((frame.flags & FRAME_COUNT) != 0u) atomicAdd(captured[number].patch_number, 1u);
}

#endif
