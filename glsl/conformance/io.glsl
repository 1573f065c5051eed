// What a control shader writes for its patch, and an evaluation shader reads: what both share.
#ifndef IO_GLSL
#define IO_GLSL

#extension GL_EXT_scalar_block_layout : require

// Control points in.
layout(constant_id = 0) const uint POINTS = 1u;
// 0: invocation 0 writes what belongs to the patch. 1: they take turns. 2: nobody writes the whole numbers. 3: what stands behind the patch's points is read as well.
layout(constant_id = 1) const uint MODE = 0u;
// Tess levels that the domain has.
layout(constant_id = 2) const uint OUTERS = 4u;
layout(constant_id = 3) const uint INNERS = 2u;

layout(set = 0, binding = 0, scalar) buffer Results {
    // Values compared, values that were wrong, and of one of these what it is, its patch and its place.
    uint compared;
    uint wrong;
    uint first_what;
    uint first_patch;
    uint first_place;
} results;

// Twin of `io::Constants`.
layout(push_constant, scalar) uniform Draw {
    // What is expected differs by this: 0, unless a fault is seeded.
    uint fault;
    // Vertices out. Not a constant: compilers took seconds to unroll loops over them.
    uint vertices;
    float outer[4];
    float inner[2];
} draw;

// A number that tells patch, what and place apart, as a float without rounding.
float content(uint number, uint what, uint place) {
    return float((number * 1031u + what * 257u + place * 37u) % 8192u);
}

void compare(bool right, uint what, uint number, uint place) {
    atomicAdd(results.compared, 1u);
    if (right) return;
    atomicAdd(results.wrong, 1u);
    results.first_what = what;
    results.first_patch = number;
    results.first_place = place;
}

#endif
