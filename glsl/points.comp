#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// A step of computing points from the control vertices, a point an invocation. Twin of `method/points.rs`.

#include "abi.glsl"
#include "lib/tangents.glsl"
#include "lib/unit.glsl"

layout(local_size_x = POINT_INVOCATIONS) in;

layout(push_constant, scalar) uniform StepBlock { PointStep point_step; };

layout(set = SET_POSE, binding = BINDING_POSITIONS, scalar) readonly buffer PositionTable { vec3 positions[]; };
layout(set = SET_POSE, binding = BINDING_POINTS, scalar) buffer PointTable { Point points[]; };
layout(set = SET_TABLES, binding = BINDING_POINT_ROWS, scalar) readonly buffer RowTable { PointRow rows[]; };
layout(set = SET_TABLES, binding = BINDING_POINT_TERMS, scalar) readonly buffer TermTable { PointTerm terms[]; };

// Sums run in the order of the terms.
void blend(PointRow row, uint number) {
    precise vec3 position = vec3(0.0);
    for (uint i = 0u; i < row.count; ++i) {
        PointTerm term = terms[row.first + i];
        position = position + term.position * positions[term.source];
    }
    points[number].position = position;
}

// The same of points of earlier steps; of many terms, by what rounding takes away from each step (Kahan 1965).
void refine(PointRow row, uint number) {
    vec3 sum = vec3(0.0);
    vec3 lost = vec3(0.0);
    for (uint i = 0u; i < row.count; ++i) {
        PointTerm term = terms[row.first + i];
        precise vec3 rest = term.position * points[term.source].position - lost;
        precise vec3 next = sum + rest;
        precise vec3 more = (next - sum) - rest;
        if (row.count > CONTROL_INVOCATIONS) lost = more;
        sum = next;
    }
    points[number].position = sum;
}

// A sum relative to the vertex of its first term, by what rounding takes away from each step: so it errs by what its distance from there has for rounding,
// wherever that is and however many terms there are.
void hub(PointRow row, uint number) {
    vec3 origin = positions[terms[row.first].source];
    vec3 sum = vec3(0.0);
    vec3 lost = vec3(0.0);
    for (uint i = 0u; i < row.count; ++i) {
        PointTerm term = terms[row.first + i];
        precise vec3 rest = term.position * (positions[term.source] - origin) - lost;
        precise vec3 next = sum + rest;
        precise vec3 more = (next - sum) - rest;
        sum = next;
        lost = more;
    }
    points[number] = Point(sum, origin);
}

// The normal of two tangents over the control vertices, relative to that of the last term, which has the greatest weight: so little is lost where
// they are small beside the model. Zero where rounding may have made it.
vec3 tangent_normal(PointRow row) {
    uint count = row.count & ~(ROW_OPEN | ROW_FIRM);
    uint greatest = 0u;
    for (uint i = 0u; i < count; ++i) greatest = max(greatest, greatest_exponent(positions[terms[row.first + i].source]));
    float size = factor_for(greatest);
    if (size == 0.0) return vec3(0.0);
    vec3 origin = sized(positions[terms[row.first + count - 1u].source], size);
    precise vec3 du = vec3(0.0);
    precise vec3 dv = vec3(0.0);
    precise vec2 spread = vec2(0.0);
    precise vec2 total = vec2(0.0);
    for (uint i = 0u; i < count; ++i) {
        PointTerm term = terms[row.first + i];
        precise vec3 spoke = sized(positions[term.source], size) - origin;
        vec2 weight = abs(vec2(term.du, term.dv));
        du = du + term.du * spoke;
        dv = dv + term.dv * spoke;
        spread = spread + weight * reach(spoke);
        total = total + weight;
    }
    precise float roundings = float(count) + 4.0;
    precise vec2 errors = ROUNDING * (roundings * spread + reach(origin) * total);
    Tangents tangents = Tangents(du, dv, errors);
    if ((row.count & ROW_FIRM) != 0u && !are_firm(tangents)) return vec3(0.0);
    return clear_normal(tangents);
}

void limit(PointRow row, uint number) {
    uint count = row.count & ~(ROW_OPEN | ROW_FIRM);
    blend(PointRow(row.first, count), number);
    points[number].normal = tangent_normal(row);
}

// Where there is no normal yet.
void spare(PointRow row, uint number) {
    if (points[number].normal == vec3(0.0)) points[number].normal = tangent_normal(row);
}

// The square of what a sum of unit normals has to be at least.
const float CANCELLED = 0.00390625;

// The weighted mean of other points' normals; zero where they cancel, as opposite ones do: what is left is then rounding.
vec3 mean_normal(PointRow row) {
    precise vec3 normal = vec3(0.0);
    for (uint i = 0u; i < row.count; ++i) {
        PointTerm term = terms[row.first + i];
        normal = normal + term.position * points[term.source].normal;
    }
    return exact_dot(normal, normal) > CANCELLED ? unit(normal) : vec3(0.0);
}

// At a cusp, and where the normal is none, or far from that nearby.
void nearby(PointRow row, uint number) {
    vec3 beside = mean_normal(row);
    bool counts = point_step.kind == POINTS_NEARBY && are_near(points[number].normal, beside);
    if (!counts && beside != vec3(0.0)) points[number].normal = beside;
}

// The areas of the triangles between the spokes. Of an open ring there is none between the last and the first. Each spoke errs by the rounding of both
// its ends, and each product by that and by its own.
void ring(PointRow row, uint number) {
    uint spokes = (row.count & ~ROW_OPEN) - 1u;
    uint faces = (row.count & ROW_OPEN) != 0u ? max(spokes, 1u) - 1u : spokes;
    uint greatest = 0u;
    for (uint i = 0u; i <= spokes; ++i) greatest = max(greatest, greatest_exponent(points[terms[row.first + i].source].position));
    float size = factor_for(greatest);
    vec3 middle = sized(points[terms[row.first].source].position, size);
    precise vec3 normal = vec3(0.0);
    precise float spread = 0.0;
    precise float total = 0.0;
    for (uint i = 0u; i < faces; ++i) {
        uint next = i + 1u < spokes ? i + 1u : 0u;
        precise vec3 a = sized(points[terms[row.first + 1u + i].source].position, size) - middle;
        precise vec3 b = sized(points[terms[row.first + 1u + next].source].position, size) - middle;
        normal = normal + exact_cross(a, b);
        spread = spread + reach(a) * reach(b);
        total = total + (reach(a) + reach(b));
    }
    precise float roundings = float(faces) + 4.0;
    precise float error = ROUNDING * (2.0 * roundings * spread + 4.0 * reach(middle) * total);
    points[number].normal = size != 0.0 && reach(normal) > CLEAR * error ? unit(normal) : vec3(0.0);
}

void main() {
    if (gl_GlobalInvocationID.x >= point_step.count) return;
    PointRow row = rows[point_step.first_row + gl_GlobalInvocationID.x];
    uint number = point_step.first_point + gl_GlobalInvocationID.x;
    switch (point_step.kind) {
    case POINTS_BLEND: blend(row, number); return;
    case POINTS_REFINE: refine(row, number); return;
    case POINTS_HUB: hub(row, number); return;
    case POINTS_LIMIT: limit(row, number); return;
    case POINTS_RING: ring(row, number); return;
    case POINTS_SPARE: spare(row, number); return;
    case POINTS_NEARBY: nearby(row, number); return;
    case POINTS_CUSP: nearby(row, number); return;
    default: points[number].normal = mean_normal(row);
    }
}
