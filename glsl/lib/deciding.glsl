// What decisions about patches go by.
#ifndef DECIDING_GLSL
#define DECIDING_GLSL

#extension GL_EXT_scalar_block_layout : require

#include "abi.glsl"

layout(push_constant, scalar) uniform DecisionBlock { Decision decision; };

layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer PatchTable { Patch patches[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer WordTable { uint words[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer SideTable { PatchSides patch_sides[]; };
layout(set = SET_TABLES, binding = BINDING_BASES, scalar) uniform BaseBlock { Bases bases; };
layout(set = SET_POSE, binding = BINDING_POSITIONS, scalar) readonly buffer PositionTable { vec3 positions[]; };
layout(set = SET_FRAME, binding = BINDING_DRAWS, scalar) buffer DrawTable { PatchDraw draws[]; };
layout(set = SET_FRAME, binding = BINDING_VIEWS, scalar) readonly buffer ViewTable { View views[]; };

// Where, among the words, the list of a side stands.
uint side_list(uint list) { return bases.own[TABLES + CACHED_TABLES + 1u] + list; }

// A row of a matrix.
vec4 row_of(mat4 matrix, uint row) { return vec4(matrix[0][row], matrix[1][row], matrix[2][row], matrix[3][row]); }

// How far in front of a plane a point is, in the plane's own units.
float before(vec4 plane, vec3 point) {
    precise float distance = ((plane.x * point.x + plane.y * point.y) + plane.z * point.z) + plane.w;
    return distance;
}

float squared(vec3 v) {
    precise float sum = (v.x * v.x + v.y * v.y) + v.z * v.z;
    return sum;
}

#endif
