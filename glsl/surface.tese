#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/interface.glsl"
#include "lib/displacement.glsl"
#include "method"

// SPACING comes from the build: one module for equal_spacing, one for fractional_even_spacing.
layout(quads, SPACING, ccw) in;

layout(location = 0) patch in uint in_patch;
#ifdef SCRATCH_RING
layout(location = 1) patch in uint in_slot;
#else
const uint in_slot = 0u;
#endif

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_uv;
layout(location = 3) out vec2 out_texture;
layout(location = 4) flat out uint out_patch;

layout(set = 0, binding = BINDING_TEXTURE, scalar) readonly buffer TextureTable { vec2 texture_corners[]; };

layout(set = 0, binding = BINDING_CAPTURE, scalar) buffer Capture {
    uint captured_count;
    Captured captured[];
};

// Records the vertex; vertices beyond the capture's end are counted all the same.
void capture(uint number, vec2 uv, vec3 position, vec3 normal) {
    uint place = atomicAdd(captured_count, 1u);
    if (place < frame.capture_vertices) captured[place] = Captured(number, uv, position, normal);
}

vec2 texture_coordinates(uint number, vec2 uv) {
    vec2 bottom = mix(texture_corners[4u * number], texture_corners[4u * number + 1u], uv.x);
    vec2 top = mix(texture_corners[4u * number + 3u], texture_corners[4u * number + 2u], uv.x);
    return mix(bottom, top, uv.y);
}

void main() {
    Patch record = patch_record(in_patch);
    vec2 uv = shared_coordinates(record, patch_levels(record), gl_TessCoord.xy);
    Surface surface = evaluate_patch(record, in_slot, uv);
    vec3 normal = surface_normal(surface);
    if (frame.displacement.x != 0.0 && has_one_normal(record, uv)) displace(surface.position, normal);
    out_position = surface.position;
    out_normal = normal;
    out_uv = uv;
    out_texture = texture_coordinates(in_patch, uv);
    out_patch = in_patch;
    gl_Position = frame.view_projection * vec4(surface.position, 1.0);
    if ((frame.flags & FRAME_PARITY) != 0u) gl_Position = amplified(gl_Position, surface.position);
    if ((frame.flags & FRAME_CAPTURE) != 0u) capture(in_patch, uv, surface.position, normal);
}
