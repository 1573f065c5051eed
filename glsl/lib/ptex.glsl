// Derivatives by a patch's own (u, v), which may be turned and a part of its ptex face, as those by the face's. Twin of `method/ptex.rs`.
#ifndef PTEX_GLSL
#define PTEX_GLSL

#include "abi.glsl"

void to_ptex_tangents(Patch record, inout vec3 du, inout vec3 dv) {
    uint child = record.flags >> PATCH_CHILD_SHIFT & 15u;
    uint turn = record.flags >> PATCH_TURN_SHIFT & 3u;
    bool triangle = child >= CHILD_OF_TRIANGLE && child < CHILD_PIECE;
    vec3 u = du;
    vec3 v = dv;
    if (turn == 1u) {
        du = -v;
        dv = triangle ? u - v : u;
    } else if (turn == 2u) {
        du = triangle ? v - u : -u;
        dv = triangle ? -u : -v;
    } else if (turn == 3u) {
        du = v;
        dv = -u;
    }
    float scale = child == 0u ? 1.0 : child == CHILD_OF_TRIANGLE + 3u ? -2.0 : 2.0;
    if (child == CHILD_PIECE) scale = float(1u << (record.plan >> PIECE_DEPTH_SHIFT));
    du *= scale;
    dv *= scale;
}

#endif
