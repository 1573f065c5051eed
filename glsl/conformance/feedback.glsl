// A geometry shader that has each primitive captured twice.
//
// Before this is included, PRIMITIVE, STRIP and VERTICES say what primitives are made of.

layout(PRIMITIVE) in;
layout(STRIP, max_vertices = 2 * VERTICES) out;

layout(xfb_buffer = 0, xfb_stride = 16) out;

layout(location = 0) flat in uint in_patch[];
layout(location = 1) in vec3 in_coordinate[];
layout(location = 0, xfb_buffer = 0, xfb_offset = 0) flat out uint out_patch;
layout(location = 1, xfb_buffer = 0, xfb_offset = 4) out vec3 out_coordinate;

void main() {
    for (int time = 0; time < 2; ++time) {
        for (int i = 0; i < VERTICES; ++i) {
            gl_Position = gl_in[i].gl_Position;
            out_patch = in_patch[i];
            out_coordinate = in_coordinate[i];
            EmitVertex();
        }
        EndPrimitive();
    }
}
