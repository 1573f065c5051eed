#version 460
#extension GL_GOOGLE_include_directive : require
// Where the control vertices are on the surface that is drawn, and their normals: what levels of edges go by, once a pose and not once an edge. An invocation
// a vertex. And the box around all vertices, by which an instance is left out as a whole. Twin of `method/limits.rs`, and of `turn` in `frame/decision.rs`.

#include "lib/deciding.glsl"

layout(local_size_x = DECIDE_INVOCATIONS) in;

layout(set = SET_POSE, binding = BINDING_LIMITS, scalar) buffer LimitTable { Point limits[]; };

const float FARTHEST = 3.4e38;

shared vec3 lows[DECIDE_INVOCATIONS];
shared vec3 highs[DECIDE_INVOCATIONS];

// The box around those of a workgroup.
void write_box(vec3 low, vec3 high, uint place) {
    uint own = gl_LocalInvocationIndex;
    lows[own] = low;
    highs[own] = high;
    barrier();
    for (uint others = DECIDE_INVOCATIONS / 2u; others > 0u; others /= 2u) {
        if (own < others) {
            lows[own] = min(lows[own], lows[own + others]);
            highs[own] = max(highs[own], highs[own + others]);
        }
        barrier();
    }
    if (own == 0u) limits[place] = Point(lows[0], highs[0]);
}

// The box around the boxes of all workgroups.
void write_whole_box() {
    uint boxes = (decision.vertices + DECIDE_INVOCATIONS - 1u) / DECIDE_INVOCATIONS;
    vec3 low = vec3(FARTHEST);
    vec3 high = vec3(-FARTHEST);
    for (uint i = gl_LocalInvocationIndex; i < boxes; i += DECIDE_INVOCATIONS) {
        Point box = limits[decision.vertices + 1u + i];
        low = min(low, box.position);
        high = max(high, box.normal);
    }
    write_box(low, high, decision.vertices);
}

// The words of a vertex: its star, then the terms of its limit.
uint ends_table() { return bases.own[TABLES + CACHED_TABLES + 2u]; }

// The normal of a vertex: of the corners of the faces around.
vec3 normal_of(vec3 from, uint place) {
    uint count = words[place];
    precise vec3 sum = vec3(0.0);
    for (uint i = 0u; i < count; ++i) {
        precise vec3 a = positions[words[place + 1u + 2u * i]] - from;
        precise vec3 b = positions[words[place + 2u + 2u * i]] - from;
        sum += vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
    }
    precise vec3 normal = sum / max(sqrt(squared(sum)), 1e-37);
    return normal;
}

// The sum of the vertices of a list.
vec3 sum_of(uint list) {
    uint place = side_list(list);
    uint count = words[place];
    precise vec3 sum = vec3(0.0);
    for (uint i = 1u; i <= count; ++i) sum += positions[words[place + i]];
    return sum;
}

// The limit of a vertex, which is where it is itself where there are no terms.
vec3 limit_of(vec3 from, uint place) {
    uint count = words[place];
    if (count == 0u) return from;
    precise vec3 limit = vec3(0.0);
    for (uint i = 0u; i < count; ++i) {
        uint source = words[place + 1u + 2u * i];
        float weight = uintBitsToFloat(words[place + 2u + 2u * i]);
        precise vec3 value = (source & LIMIT_FACE) != 0u ? sum_of(source & ~LIMIT_FACE) : positions[source];
        precise vec3 term = weight * value;
        limit += term;
    }
    return limit;
}

void main() {
    if ((decision.flags & DECIDE_BOX) != 0u) {
        write_whole_box();
        return;
    }
    uint vertex = gl_GlobalInvocationID.x;
    uint ends = ends_table();
    vec3 low = vec3(FARTHEST);
    vec3 high = vec3(-FARTHEST);
    if (vertex < decision.vertices) {
        uint place = ends + words[ends + 1u + vertex];
        vec3 from = positions[vertex];
        limits[vertex].position = limit_of(from, place + 1u + 2u * words[place]);
        if ((decision.flags & DECIDE_CURVATURE) != 0u) limits[vertex].normal = normal_of(from, place);
        // What no face uses may be anywhere.
        if (words[place] > 0u) {
            low = from;
            high = from;
        }
    }
    if ((decision.flags & DECIDE_FRUSTUM) != 0u) write_box(low, high, decision.vertices + 1u + gl_WorkGroupID.x);
}
