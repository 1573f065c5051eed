#version 460

// Hands on its triangle once an invocation, each in a column of the picture. The number of invocations is an execution mode, which the host rewrites in the
// module.

layout(triangles, invocations = 2) in;
layout(triangle_strip, max_vertices = 3) out;

// Columns of the picture.
layout(constant_id = 0) const uint COLUMNS = 1u;

layout(location = 0) flat in uint in_patch[];
layout(location = 0) flat out uint out_patch;

void main() {
    float width = 2.0 / float(COLUMNS);
    for (int i = 0; i < 3; ++i) {
        vec2 place = 0.5 * (gl_in[i].gl_Position.xy + 1.0);
        gl_Position = vec4((place.x + float(gl_InvocationID)) * width - 1.0, 2.0 * place.y - 1.0, 0.0, 1.0);
        out_patch = uint(gl_InvocationID) * 16u + in_patch[i];
        EmitVertex();
    }
    EndPrimitive();
}
