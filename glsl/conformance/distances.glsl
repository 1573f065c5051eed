// An evaluation shader with distances, one of which is negative on the side of u = 0. Before this is included, DISTANCES is which distances.

#extension GL_EXT_scalar_block_layout : require

layout(quads, equal_spacing, ccw) in;

// Which distance it is; 8 for none.
layout(constant_id = 0) const uint PLACE = 8u;

// Where it is zero.
layout(push_constant, scalar) uniform Draw { float cut; };

out gl_PerVertex {
    vec4 gl_Position;
    float DISTANCES[8];
};

layout(location = 0) patch in uint in_patch;
layout(location = 0) flat out uint out_patch;

void main() {
    out_patch = in_patch;
    gl_Position = vec4(2.0 * gl_TessCoord.xy - 1.0, 0.0, 1.0);
    for (uint i = 0u; i < 8u; ++i) DISTANCES[i] = i == PLACE ? gl_TessCoord.x - cut : 1.0;
}
