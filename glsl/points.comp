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

struct Tangents {
    vec3 du;
    vec3 dv;
};

// Two tangents, times a power of two.
Tangents scaled_tangents(PointRow row, float factor) {
    precise vec3 du = vec3(0.0);
    precise vec3 dv = vec3(0.0);
    for (uint i = 0u; i < row.count; ++i) {
        PointTerm term = terms[row.first + i];
        precise vec3 vertex = factor * positions[term.source];
        du = du + term.du * vertex;
        dv = dv + term.dv * vertex;
    }
    return Tangents(du, dv);
}

// Two tangents, of any length. Where sums leave the range of floats, vertices are scaled first.
Tangents tangents_of(PointRow row) {
    Tangents tangents = scaled_tangents(row, 1.0);
    if (is_firm(tangents.du) && is_firm(tangents.dv)) return tangents;
    uint greatest = 0u;
    for (uint i = 0u; i < row.count; ++i) greatest = max(greatest, greatest_exponent(positions[terms[row.first + i].source]));
    return scaled_tangents(row, factor_for(greatest));
}

void limit(PointRow row, uint number) {
    precise vec3 position = vec3(0.0);
    for (uint i = 0u; i < row.count; ++i) {
        PointTerm term = terms[row.first + i];
        position = position + term.position * positions[term.source];
    }
    Tangents tangents = tangents_of(row);
    points[number] = Point(position, unit(exact_cross(unit(tangents.du), unit(tangents.dv))));
}

// Of an open ring there is no face between the last and the first.
void ring(PointRow row, uint number) {
    uint spokes = (row.count & ~ROW_OPEN) - 1u;
    uint faces = (row.count & ROW_OPEN) != 0u ? max(spokes, 1u) - 1u : spokes;
    vec3 middle = points[terms[row.first].source].position;
    Scaled normal = Scaled(vec3(0.0), 0);
    for (uint i = 0u; i < faces; ++i) {
        uint next = i + 1u < spokes ? i + 1u : 0u;
        Scaled a = difference(points[terms[row.first + 1u + i].source].position, middle);
        Scaled b = difference(points[terms[row.first + 1u + next].source].position, middle);
        normal = scaled_sum(normal, scaled_cross(a, b));
    }
    points[number].normal = unit(normal.vector);
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
