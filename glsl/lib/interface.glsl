// What every stage sees: push constants, and the tables that all methods share. A method's own tables are declared in its file.
#ifndef INTERFACE_GLSL
#define INTERFACE_GLSL

#extension GL_EXT_scalar_block_layout : require

#include "abi.glsl"

layout(push_constant, scalar) uniform FrameBlock { Frame frame; };

// All tables of a pass are in one buffer: blocks of one binding see it as elements of theirs, from 0 on. Nothing writes it.
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer PatchTable { Patch patches[]; };
layout(set = SET_TABLES, binding = BINDING_TABLES, scalar) readonly buffer ControlTable { uint words[]; };
layout(set = SET_TABLES, binding = BINDING_BASES, scalar) uniform BaseBlock { Bases bases; };
layout(set = SET_POSE, binding = BINDING_POSITIONS, scalar) readonly buffer PositionTable { vec3 positions[]; };
layout(set = SET_FRAME, binding = BINDING_DRAWS, scalar) readonly buffer DrawTable { PatchDraw draws[]; };
layout(set = SET_FRAME, binding = BINDING_DRAWS, scalar) readonly buffer SubPatchTable { SubPatch sub_patches[]; };
layout(set = SET_FRAME, binding = BINDING_VIEWS, scalar) readonly buffer ViewTable { View views[]; };

// Entry `place` of the lists of control vertices.
uint control_at(uint place) { return words[bases.controls + place]; }

// The patch of a number; surplus numbers of the last instance read the last patch and are not drawn.
Patch patch_record(uint number) { return patches[min(number, frame.end_patch - 1u)]; }

// Whether pipelines draw patches that may be cut into pieces: a constant, so that others run no code for it. An engine's own fragment shaders have no such
// constant, and ask the frame.
#if defined(STAGE_VERTEX) || defined(STAGE_CONTROL) || defined(STAGE_EVALUATION) || defined(CONSTANT_SUB_PATCHES)
layout(constant_id = CONSTANT_ID_SUB_PATCHES) const bool SUB_PATCHES = false;
#else
const bool SUB_PATCHES = true;
#endif

bool are_sub_patches() { return SUB_PATCHES && (frame.flags & FRAME_SUB_PATCHES) != 0u; }

// The patch that is drawn under a number: the same, or that of a sub-patch, whose number is never the greater.
uint patch_of(uint number) { return are_sub_patches() ? sub_patches[min(number, frame.end_patch - 1u)].patch_number : number; }

// What fragment shaders are told of what is drawn and a view, in one number: geometry shaders have no component to spare for two. What is drawn is a patch,
// or else a sub-patch.
uint drawn_key(uint number, uint view) { return view * frame.end_patch + number; }
uint drawn_number(uint key) { return key % frame.end_patch; }
uint drawn_patch(uint key) { return patch_of(drawn_number(key)); }
uint drawn_view(uint key) { return key / frame.end_patch; }

#endif
