#version 460
#extension GL_GOOGLE_include_directive : require

// Shading for people who have no renderer of their own: lit, or telling what the surface is made of.

#include "lib/interface.glsl"
#include "method"
#include "lib/shading.glsl"

// Centroid: at silhouettes a pixel's middle lies outside of the triangle, and extrapolated normals would glitter.
layout(location = 0) centroid in vec3 in_position;
layout(location = 1) centroid in vec3 in_normal;
layout(location = 2) centroid in vec2 in_uv;
layout(location = 3) centroid in vec2 in_texture;
layout(location = 4) flat in uint in_patch;

layout(location = 0) out vec4 out_colour;

// A colour a node kind, and a fine dark line around each cell of the quadtree.
vec3 node_colour(Patch record, vec2 pixel) {
    Cell cell = cell_at(record, in_uv);
    vec2 from_edge = min(cell.uv, 1.0 - cell.uv) / max(pixel * cell.scale, vec2(1e-6));
    float line = 1.0 - smoothstep(0.5, 1.5, min(from_edge.x, from_edge.y));
    return kind_colour(cell.kind) * (1.0 - 0.55 * line);
}

// The valence of the nearest corner: warm below four, cool above, fading towards the middle of the patch.
vec3 valence_colour(Patch record) {
    uint corner = in_uv.y < 0.5 ? (in_uv.x < 0.5 ? 0u : 1u) : (in_uv.x < 0.5 ? 3u : 2u);
    float valence = float(record.valences >> (8u * corner) & 255u);
    vec2 distance = min(in_uv, 1.0 - in_uv);
    float strength = 1.0 - smoothstep(0.0, 0.5, length(distance));
    vec3 extreme = valence < 4.0 ? vec3(0.9, 0.35, 0.12) : vec3(0.12, 0.4, 0.85);
    float amount = valence == 4.0 ? 0.0 : clamp(0.45 + 0.2 * abs(valence - 4.0), 0.0, 1.0);
    return mix(vec3(0.72), extreme, amount * strength);
}

void main() {
    Patch record = patch_record(in_patch);
    vec2 pixel = fwidth(in_uv);
    vec3 normal = normalize(in_normal);
    vec3 to_eye = normalize(frame.eye - in_position);
    if (dot(normal, to_eye) < 0.0) normal = -normal;
    switch (frame.shading) {
    case SHADING_NORMAL: out_colour = vec4(0.5 + 0.5 * normalize(in_normal), 1.0); return;
    case SHADING_LINES: out_colour = vec4(vec3(0.02), 1.0); return;
    case SHADING_PATCH: out_colour = vec4(lit(patch_colour(in_patch * 2u + record.ptex), normal, to_eye, 0.25), 1.0); return;
    case SHADING_NODE: out_colour = vec4(lit(node_colour(record, pixel), normal, to_eye, 0.25), 1.0); return;
    case SHADING_VALENCE: out_colour = vec4(lit(valence_colour(record), normal, to_eye, 0.25), 1.0); return;
    default: out_colour = vec4(lit(vec3(0.56, 0.33, 0.22), normal, to_eye, 1.0), 1.0);
    }
}
