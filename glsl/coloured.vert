#version 460

// Triangles that the host has already projected and coloured: maps of a number over a surface.

invariant gl_Position;

layout(location = 0) in vec4 in_clip;
layout(location = 1) in vec4 in_colour;

layout(location = 0) out vec4 out_colour;

// Whether a vertex has come.
layout(set = 0, binding = 0) writeonly buffer Seen { uint seen[]; };

void main() {
    seen[gl_VertexIndex] = 1u;
    gl_Position = in_clip;
    out_colour = in_colour;
}
