#version 460
#extension GL_EXT_scalar_block_layout : require

// The skinning of examples/engine: two bones, the upper of which is turned about the lower's end. It writes a pose's control vertices.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, scalar) readonly buffer Rest { vec3 rest[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Positions { vec3 positions[]; };

// Twin of `Bones` in examples/engine/skin.rs.
layout(push_constant, scalar) uniform Bones {
    mat4 upper;
    float from;
    float to;
    uint count;
} bones;

void main() {
    uint number = gl_GlobalInvocationID.x;
    if (number >= bones.count) return;
    vec3 position = rest[number];
    float weight = smoothstep(bones.from, bones.to, position.y);
    vec3 turned = (bones.upper * vec4(position, 1.0)).xyz;
    positions[number] = mix(position, turned, weight);
}
