#version 460
#extension GL_EXT_scalar_block_layout : require

// A point a vertex, of a size that the draw says. Domain, spacing and order are execution modes, which the host rewrites in the module.

layout(quads, equal_spacing, ccw) in;

// Twin of `geometry::points::Constants`.
layout(push_constant, scalar) uniform Draw {
    float size;
    // The picture's side, the pixel of (0, 0), and pixels from there to (1, 1).
    float side;
    float first;
    float spread;
};

out gl_PerVertex {
    vec4 gl_Position;
    float gl_PointSize;
};

layout(location = 0) patch in uint in_patch;
layout(location = 0) flat out uint out_patch;

void main() {
    out_patch = in_patch;
    vec2 pixel = first + spread * gl_TessCoord.xy;
    gl_Position = vec4(2.0 * pixel / side - 1.0, 0.0, 1.0);
    gl_PointSize = size;
}
