#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// A step of computing points from the control vertices, a point an invocation. Twin of `method/points.rs`.

#include "abi.glsl"
#include "lib/unit.glsl"

layout(local_size_x = POINT_INVOCATIONS) in;

layout(push_constant, scalar) uniform StepBlock { PointStep point_step; };

layout(set = 0, binding = BINDING_POSITIONS, scalar) readonly buffer PositionTable { vec3 positions[]; };
layout(set = 0, binding = BINDING_POINTS, scalar) buffer PointTable { Point points[]; };
layout(set = 0, binding = BINDING_POINT_ROWS, scalar) readonly buffer RowTable { PointRow rows[]; };
layout(set = 0, binding = BINDING_POINT_TERMS, scalar) readonly buffer TermTable { PointTerm terms[]; };

// Sums run in the order of the terms.
void blend(PointRow row, uint number) {
    precise vec3 position = vec3(0.0);
    for (uint i = 0u; i < row.count; ++i) {
        PointTerm term = terms[row.first + i];
        position = position + term.position * positions[term.source];
    }
    points[number].position = position;
}

void limit(PointRow row, uint number) {
    precise vec3 position = vec3(0.0);
    precise vec3 du = vec3(0.0);
    precise vec3 dv = vec3(0.0);
    for (uint i = 0u; i < row.count; ++i) {
        PointTerm term = terms[row.first + i];
        vec3 vertex = positions[term.source];
        position = position + term.position * vertex;
        du = du + term.du * vertex;
        dv = dv + term.dv * vertex;
    }
    points[number] = Point(position, unit(exact_cross(unit(du), unit(dv))));
}

// Of an open ring there is no face between the last and the first.
void ring(PointRow row, uint number) {
    uint spokes = (row.count & ~ROW_OPEN) - 1u;
    uint faces = (row.count & ROW_OPEN) != 0u ? max(spokes, 1u) - 1u : spokes;
    vec3 middle = points[terms[row.first].source].position;
    precise vec3 normal = vec3(0.0);
    for (uint i = 0u; i < faces; ++i) {
        uint next = i + 1u < spokes ? i + 1u : 0u;
        precise vec3 a = points[terms[row.first + 1u + i].source].position - middle;
        precise vec3 b = points[terms[row.first + 1u + next].source].position - middle;
        normal = normal + exact_cross(a, b);
    }
    points[number].normal = unit(normal);
}

void normals(PointRow row, uint number) {
    precise vec3 normal = vec3(0.0);
    for (uint i = 0u; i < row.count; ++i) {
        PointTerm term = terms[row.first + i];
        normal = normal + term.position * points[term.source].normal;
    }
    points[number].normal = unit(normal);
}

void main() {
    if (gl_GlobalInvocationID.x >= point_step.count) return;
    PointRow row = rows[point_step.first_row + gl_GlobalInvocationID.x];
    uint number = point_step.first_point + gl_GlobalInvocationID.x;
    switch (point_step.kind) {
    case POINTS_BLEND: blend(row, number); return;
    case POINTS_LIMIT: limit(row, number); return;
    case POINTS_RING: ring(row, number); return;
    default: normals(row, number);
    }
}
