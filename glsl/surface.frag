#version 460
#extension GL_GOOGLE_include_directive : require

// Shading for people who have no renderer of their own: lit, or telling what the surface is made of.

#define CONSTANT_SUB_PATCHES
#include "lib/interface.glsl"
#include "method"
#include "lib/displacement.glsl"
#include "lib/levels.glsl"
#include "lib/shading.glsl"
#include "lib/sub_patch.glsl"

// One of SHADING_...; a constant of the pipeline, so that no fragment pays for what others are shaded by.
layout(constant_id = CONSTANT_ID_SHADING) const uint SHADING = SHADING_LIT;

// Centroid: at silhouettes a pixel's middle lies outside of the triangle, and extrapolated normals would glitter. A position may: it is where
// the pixel's own line of sight meets the triangle's plane, and differences from pixel to pixel lie in that plane.
layout(location = 0) in vec3 in_position;
layout(location = 1) centroid in vec3 in_normal;
layout(location = 2) centroid in vec2 in_uv;
layout(location = 3) centroid in vec2 in_texture;
layout(location = 4) flat in uint in_drawn;

layout(location = 0) out vec4 out_colour;

// A fine dark line around each cell of the quadtree.
float cell_line(Cell cell, vec2 pixel) {
    vec2 from_edge = min(cell.uv, 1.0 - cell.uv) / max(pixel * cell.scale, vec2(1e-6));
    return 1.0 - 0.55 * (1.0 - smoothstep(0.5, 1.5, min(from_edge.x, from_edge.y)));
}

// A colour a node kind.
vec3 node_colour(Patch record, vec2 pixel) {
    Cell cell = cell_at(record, in_uv);
    return kind_colour(cell.kind) * cell_line(cell, pixel);
}

// A colour a level of the quadtree: each is half as large as the one above it.
vec3 depth_colour(Patch record, vec2 pixel) {
    Cell cell = cell_at(record, in_uv);
    return ramp(log2(max(cell.scale, 1.0)) / float(HIGHEST_LEVEL)) * cell_line(cell, pixel);
}

// The level of the edge that is near, else that of the inside; each power of two is a sixth of the ramp.
vec3 level_colour(uint number, uint view, Patch record) {
    Levels levels = whole_levels(number, view, record);
    float level = levels.inside;
    float near = 0.15;
#ifdef TRIANGLES
    vec3 away = vec3(in_uv.y, 1.0 - in_uv.x - in_uv.y, in_uv.x);
    for (uint i = 0u; i < 3u; ++i)
#else
    vec4 away = vec4(in_uv.y, 1.0 - in_uv.x, 1.0 - in_uv.y, in_uv.x);
    for (uint i = 0u; i < 4u; ++i)
#endif
    {
        if (away[i] < near) {
            near = away[i];
            level = levels.edges[i];
        }
    }
    return ramp(log2(clamp(level, 1.0, 64.0)) / 6.0);
}

// Squares of texture coordinates, each pixel with the mean over what it covers.
vec3 checker_colour() {
    vec2 at = 8.0 * in_texture;
    vec2 width = max(fwidth(at), vec2(1e-5));
    vec2 sum = abs(fract(0.5 * (at - 0.5 * width)) - 0.5) - abs(fract(0.5 * (at + 0.5 * width)) - 0.5);
    vec2 mean = 2.0 * sum / width;
    return mix(vec3(0.10, 0.11, 0.13), vec3(0.72, 0.70, 0.66), 0.5 - 0.5 * mean.x * mean.y);
}

// How far bumps have lifted a point. It is only known where it is now: where it was follows by going back along the normal some times, each
// nearer than the one before, since bumps are low beside their width.
vec3 height_colour(vec2 displacement) {
    if (displacement.x == 0.0) return vec3(0.3);
    vec3 normal = direction(in_normal);
    vec3 slope;
    float height = 0.0;
    for (uint i = 0u; i < 4u; ++i) {
        height = bumps((in_position - displacement.x * height * normal) * displacement.y, slope);
    }
    return ramp(height);
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

// The direction in which the pixel is seen. Of a triangle that is seen from its edge the line of sight may meet the plane behind the eye, or
// nowhere.
vec3 towards_eye(vec3 eye, vec3 back) {
    vec3 to_eye = direction(eye - in_position);
    float along = dot(to_eye, back);
    return along > 0.0 ? to_eye : along < 0.0 ? -to_eye : back;
}

// The normal of the side that is seen. gl_FrontFacing tells the side, not the normal itself: at a silhouette that points away from the eye on
// triangles that are seen from their front. Only where the surface folds over within a flat side triangles are turned over, or the normals at
// their corners are; both shall look like the side around them, and there the triangle's plane and what the eye sees agree against the facing.
// Each of the two alone is lost in rounding somewhere: the plane on slivers, the eye's view at silhouettes. Where the surface has no normal, or
// opposite ones meet, the plane's will do.
vec3 normal_of_side(vec3 to_eye) {
    vec3 plane = cross(scaled(dFdx(in_position)), scaled(dFdy(in_position)));
    if (dot(plane, to_eye) < 0.0) plane = -plane;
    vec3 normal = direction(in_normal);
    if (normal == vec3(0.0)) return plane == vec3(0.0) ? to_eye : direction(plane);
    if (!gl_FrontFacing) normal = -normal;
    return dot(normal, plane) < 0.0 && dot(normal, to_eye) < -0.1 ? -normal : normal;
}

// Of a smooth surface nothing is seen whose normal points away: triangles that stand for it at a silhouette are lit as it is on this side of its
// horizon.
vec3 seen_normal(vec3 to_eye) {
    vec3 normal = normal_of_side(to_eye);
    return normal - 2.0 * min(dot(normal, to_eye), 0.0) * to_eye;
}

void main() {
    uint number = drawn_patch(in_drawn);
    Patch record = patch_record(number);
    vec2 pixel = fwidth(in_uv);
#ifdef MACRO_FACES
    pixel = cell_pixel(record, in_uv, pixel);
#endif
    uint view = drawn_view(in_drawn);
    vec3 right = views[view].right;
    vec3 back = views[view].back;
    vec3 to_eye = towards_eye(views[view].eye, back);
    vec3 normal = seen_normal(to_eye);
    vec3 colour = vec3(0.56, 0.33, 0.22);
    float gloss = 0.25;
    switch (SHADING) {
    case SHADING_NORMAL: out_colour = vec4(0.5 + 0.5 * direction(in_normal), 1.0); return;
    case SHADING_LINES: out_colour = vec4(vec3(0.02), 1.0); return;
    case SHADING_PATCH: colour = patch_colour(number * 2u + record.ptex); break;
    case SHADING_NODE: colour = node_colour(record, pixel); break;
    case SHADING_VALENCE: colour = valence_colour(record); break;
    case SHADING_LEVEL: colour = level_colour(drawn_number(in_drawn), view, record); break;
    case SHADING_CHECKER: colour = checker_colour(); break;
    case SHADING_DEPTH: colour = depth_colour(record, pixel); break;
    case SHADING_HEIGHT: colour = height_colour(views[view].displacement); break;
    default: gloss = 1.0;
    }
    out_colour = vec4(lit(colour, normal, to_eye, right, back, gloss), 1.0);
}
