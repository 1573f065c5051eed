// What every stage sees: push constants, and the tables that all methods share. A method's own tables are declared in its file.
#ifndef INTERFACE_GLSL
#define INTERFACE_GLSL

#extension GL_EXT_scalar_block_layout : require

#include "abi.glsl"

layout(push_constant, scalar) uniform FrameBlock { Frame frame; };

layout(set = 0, binding = BINDING_POSITIONS, scalar) readonly buffer PositionTable { vec3 positions[]; };
layout(set = 0, binding = BINDING_PATCHES, scalar) readonly buffer PatchTable { Patch patches[]; };
layout(set = 0, binding = BINDING_CONTROLS, scalar) readonly buffer ControlTable { uint controls[]; };
layout(set = 0, binding = BINDING_DRAWS, scalar) readonly buffer DrawTable { PatchDraw draws[]; };

// The patch of a number; surplus numbers of the last instance read the last patch and are not drawn.
Patch patch_record(uint number) { return patches[min(number, frame.end_patch - 1u)]; }

#endif
