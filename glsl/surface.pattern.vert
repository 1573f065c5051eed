#version 460
#extension GL_GOOGLE_include_directive : require

// A vertex of a refinement pattern, evaluated on the patch of its instance (Boubekeur, Schlick 2007, section 3.2).

#include "lib/instances.glsl"
#include "lib/whole.glsl"
#include "lib/vertex.glsl"

layout(set = SET_FRAME, binding = BINDING_INSTANCES, scalar) readonly buffer InstanceTable { uint instances[]; };

void main() {
    uint number = instances[frame.first_patch + instance_part()];
    Patch record = patch_record(number);
    fit_patch(record);
    if (TANGENTS) tangent_level = required_level(patch_levels(number, instance_view(), record));
    uint index = uint(gl_VertexIndex);
    uvec2 place = uvec2(index & ((1u << PATTERN_SHIFT) - 1u), index >> PATTERN_SHIFT);
    vec2 uv = lattice_uv(place, frame.flags >> FRAME_SEGMENTS_SHIFT & 127u);
    write_vertex(record, number, instance_view(), uv, evaluate_patch(record, slot_of(number), uv));
}
