// A procedural displacement along the normal, to show that it opens no cracks, the twin of `method::Displacement`; and one that makes cracks
// visible.
#ifndef DISPLACEMENT_GLSL
#define DISPLACEMENT_GLSL

#include "lib/interface.glsl"
#include "lib/surface.glsl"

// Bumps on a lattice, 0..1, smooth once; and their slope along each axis.
float bumps(vec3 at, out vec3 slope) {
    precise vec3 f = at - floor(at);
    precise vec3 rest = 1.0 - f;
    precise vec3 wave = (f * rest) * (f * rest) * 16.0;
    precise float height = ((wave.x + wave.y) + wave.z) / 3.0;
    precise vec3 steep = (f * rest) * (rest - f) * (32.0 / 3.0);
    slope = steep;
    return height;
}

// Moves a point along its normal; the normal follows to first order. Nothing but position and normal has a say: where faces have the same bits
// of both, they still have them afterwards. `displacement` is its height, and its waves per unit of length.
void displace(vec2 displacement, inout vec3 position, inout vec3 normal) {
    vec3 slope;
    precise vec3 at = position * displacement.y;
    float height = bumps(at, slope);
    precise vec3 moved = position + (displacement.x * height) * normal;
    precise vec3 gradient = slope * (displacement.x * displacement.y);
    precise float along = (gradient.x * normal.x + gradient.y * normal.y) + gradient.z * normal.z;
    precise vec3 tilted = normal - (gradient - along * normal);
    position = moved;
    normal = unit(tilted);
}

// The derivatives of what is so moved, to first order as well; of the point and the normal before.
void displace_tangents(vec2 displacement, vec3 position, vec3 normal, inout vec3 du, inout vec3 dv) {
    vec3 slope;
    precise vec3 at = position * displacement.y;
    bumps(at, slope);
    precise vec3 gradient = slope * (displacement.x * displacement.y);
    precise vec3 moved_du = du + exact_dot(gradient, du) * normal;
    precise vec3 moved_dv = dv + exact_dot(gradient, dv) * normal;
    du = moved_du;
    dv = moved_dv;
}

// The crack amplifier of VK-GL-CTS: where the bits of a position are odd in number, the vertex moves by a fiftieth of the picture. If faces
// differ by a single bit somewhere on an edge, a hole opens there that one can see.
vec4 amplified(vec4 clip, vec3 position) {
    uvec3 bits = floatBitsToUint(position);
    bool odd = (bitCount(bits.x ^ bits.y ^ bits.z) & 1) != 0;
    return odd ? clip + vec4(0.04, 0.04, 0.0, 0.0) * clip.w : clip;
}

#endif
