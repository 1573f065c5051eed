#version 460

// Hands on its own number, as a number of the primitive and as a value, or makes one of the patch's.

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

// 0 is the control shader's.
layout(constant_id = 1) const uint MADE = 0u;

layout(location = 0) flat in uint in_patch[];
layout(location = 0) flat out uint out_patch;
layout(location = 1) flat out uint out_number;

void main() {
    // Twin of `primitive_id::made`.
    int made = int(7u * in_patch[0] + 3u);
    for (int i = 0; i < 3; ++i) {
        gl_Position = gl_in[i].gl_Position;
        gl_PrimitiveID = MADE == 1u ? made : gl_PrimitiveIDIn;
        out_patch = in_patch[0];
        out_number = uint(gl_PrimitiveIDIn);
        EmitVertex();
    }
    EndPrimitive();
}
