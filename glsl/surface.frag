#version 460
#extension GL_GOOGLE_include_directive : require

// Shading for people who have no renderer of their own: lit, or telling what the surface is made of.

#include "lib/interface.glsl"
#include "lib/surface.glsl"
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

// The normal of the side that is seen. That goes by the triangle: at a silhouette one that is seen from its front still has normals that
// point away from the eye. Where the surface has no normal, or opposite ones meet, the triangle's own will do.
vec3 seen_normal(vec3 to_eye) {
    vec3 across = normalize_or_zero(dFdx(in_position));
    vec3 down = normalize_or_zero(dFdy(in_position));
    vec3 normal = normalize_or_zero(in_normal);
    if (normal != vec3(0.0)) return gl_FrontFacing ? normal : -normal;
    vec3 plane = normalize_or_zero(cross(across, down));
    if (plane == vec3(0.0)) return to_eye;
    return dot(plane, to_eye) < 0.0 ? -plane : plane;
}

void main() {
    Patch record = patch_record(in_patch);
    vec2 pixel = fwidth(in_uv);
    vec3 to_eye = normalize_or_zero(frame.eye - in_position);
    vec3 normal = seen_normal(to_eye);
    Axes view = view_axes(frame.view_projection, to_eye);
    vec3 colour = vec3(0.56, 0.33, 0.22);
    float gloss = 0.25;
    switch (frame.shading) {
    case SHADING_NORMAL: out_colour = vec4(0.5 + 0.5 * normalize_or_zero(in_normal), 1.0); return;
    case SHADING_LINES: out_colour = vec4(vec3(0.02), 1.0); return;
    case SHADING_PATCH: colour = patch_colour(in_patch * 2u + record.ptex); break;
    case SHADING_NODE: colour = node_colour(record, pixel); break;
    case SHADING_VALENCE: colour = valence_colour(record); break;
    default: gloss = 1.0;
    }
    out_colour = vec4(lit(colour, normal, to_eye, view, gloss), 1.0);
}
