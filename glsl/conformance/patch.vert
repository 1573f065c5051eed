#version 460

// Hands on where each control point comes from; the control shaders make the patch's number of it.

layout(location = 0) out uint out_vertex;
layout(location = 1) out uint out_instance;

void main() {
    out_vertex = uint(gl_VertexIndex);
    out_instance = uint(gl_InstanceIndex);
    // Control shaders do not read it, but nothing is undefined.
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
