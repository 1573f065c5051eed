#version 460
#extension GL_EXT_scalar_block_layout : require

// Triangles whose corners are given, in clip space.

layout(triangles, equal_spacing, cw) in;

layout(location = 0) patch in uint in_patch;

layout(set = 0, binding = 0, scalar) readonly buffer Corners { vec2 corners[]; };

void main() {
    uint corner = gl_TessCoord.x > 0.5 ? 0u : gl_TessCoord.y > 0.5 ? 1u : 2u;
    gl_Position = vec4(corners[3u * in_patch + corner], 0.5, 1.0);
}
