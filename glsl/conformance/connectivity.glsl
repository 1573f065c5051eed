// A geometry shader that notes each primitive with the tess coordinates of its vertices, and hands it on.
//
// Before this is included, PRIMITIVE, STRIP and VERTICES say what primitives are made of.

#extension GL_EXT_scalar_block_layout : require

layout(PRIMITIVE) in;
layout(STRIP, max_vertices = VERTICES) out;

layout(location = 0) flat in uint in_patch[];
layout(location = 1) in vec3 in_coordinate[];
layout(location = 0) flat out uint out_patch;

struct Primitive {
    uint number;
    vec3 coordinates[VERTICES];
};
layout(set = 0, binding = 1, scalar) buffer Recorded {
    uint count;
    Primitive recorded[];
};
layout(push_constant, scalar) uniform Draw { uint room; };

void main() {
    uint place = atomicAdd(count, 1u);
    if (place < room) {
        recorded[place].number = in_patch[0];
        for (int i = 0; i < VERTICES; ++i) recorded[place].coordinates[i] = in_coordinate[i];
    }
    for (int i = 0; i < VERTICES; ++i) {
        gl_Position = gl_in[i].gl_Position;
        out_patch = in_patch[i];
        EmitVertex();
    }
    EndPrimitive();
}
