#version 460
#extension GL_EXT_scalar_block_layout : require

// Records its tess coordinates. Domain, spacing, order and point mode are execution modes, which the host rewrites in the module.

layout(quads, equal_spacing, ccw) in;

layout(location = 0) patch in uint in_patch;
layout(location = 0) flat out uint out_patch;

struct Coordinate {
    uint number;
    vec3 coordinate;
};
layout(set = 0, binding = 1, scalar) buffer Recorded {
    uint count;
    Coordinate recorded[];
};
layout(push_constant, scalar) uniform Draw { uint room; };

void main() {
    uint place = atomicAdd(count, 1u);
    if (place < room) recorded[place] = Coordinate(in_patch, gl_TessCoord);
    out_patch = in_patch;
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
}
