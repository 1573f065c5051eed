// The lattice of a face whose limit is a table. Twin of `method/bft/lattice.rs`.
#ifndef LATTICE_GLSL
#define LATTICE_GLSL

#include "abi.glsl"

// Rows of a table with their shares, which sum to 1; unused ones have none.
struct Shares {
    uvec4 rows;
    vec4 shares;
};

// How many rows there are, up to the last that has a share: of a point of the lattice itself only one.
uint row_count(Shares shares) {
    vec4 of = shares.shares;
    return of.w != 0.0 ? 4u : of.z != 0.0 ? 3u : of.y != 0.0 ? 2u : 1u;
}

// Point `step` of an edge, counted from its first corner; the last is the next corner.
uint edge_row(TableFace face, uint side, uint count) {
    if (count == 0u) return side;
    if (count == face.segments) return (side + 1u) % face.corners;
    return face.corners + side * (face.segments - 1u) + count - 1u;
}

// The point at column i and line j: corners, then edges, then what is inside.
uint lattice_row(TableFace face, uint i, uint j) {
    uint n = face.segments;
    if (j == 0u) return edge_row(face, 0u, i);
    if (i == 0u) return edge_row(face, face.corners - 1u, n - j);
    uint first = face.corners * n;
    if (face.corners == 3u) {
        if (i + j >= n) return edge_row(face, 1u, j);
        return first + (j - 1u) * (n - 1u) - j * (j - 1u) / 2u + i - 1u;
    }
    if (i == n) return edge_row(face, 1u, j);
    if (j == n) return edge_row(face, 2u, n - i);
    return first + (j - 1u) * (n - 1u) + i - 1u;
}

// Between two points of an edge, counted in segments from its first corner.
Shares lattice_along(TableFace face, uint side, float at) {
    uint count = min(uint(at), face.segments - 1u);
    precise float part = at - float(count);
    precise float rest = 1.0 - part;
    return Shares(uvec4(edge_row(face, side, count), edge_row(face, side, count + 1u), 0u, 0u), vec4(rest, part, 0.0, 0.0));
}

// Between the corners of the finest triangle or quad around a point inside: the linear geomorph of section II-C.
Shares lattice_inside(TableFace face, vec2 uv) {
    uint n = face.segments;
    precise vec2 at = uv * float(n);
    uint i = min(uint(at.x), n - 1u);
    uint j = min(uint(at.y), face.corners == 3u ? n - 1u - i : n - 1u);
    precise vec2 part = at - vec2(i, j);
    precise vec2 rest = 1.0 - part;
    uint here = lattice_row(face, i, j);
    uint right = lattice_row(face, i + 1u, j);
    uint above = lattice_row(face, i, j + 1u);
    if (face.corners == 4u) {
        uint beyond = lattice_row(face, i + 1u, j + 1u);
        precise vec4 shares = vec4(rest.x * rest.y, part.x * rest.y, part.x * part.y, rest.x * part.y);
        return Shares(uvec4(here, right, beyond, above), shares);
    }
    precise float over = (part.x + part.y) - 1.0;
    if (over <= 0.0 || i + j + 2u > n) {
        precise float near = rest.x - part.y;
        return Shares(uvec4(here, right, above, 0u), vec4(near, part, 0.0));
    }
    return Shares(uvec4(lattice_row(face, i + 1u, j + 1u), above, right, 0u), vec4(over, rest, 0.0));
}

// What the shares of a point inside change by with u and v: those of its triangle or quad, which are its neighbour's on the other side of a line. Both have
// the rows of `lattice_inside`.
struct Changes {
    vec4 by_u;
    vec4 by_v;
};

Changes lattice_changes(TableFace face, vec2 uv) {
    uint n = face.segments;
    precise vec2 at = uv * float(n);
    uint i = min(uint(at.x), n - 1u);
    uint j = min(uint(at.y), face.corners == 3u ? n - 1u - i : n - 1u);
    precise vec2 part = at - vec2(i, j);
    precise vec2 rest = 1.0 - part;
    if (face.corners == 4u) {
        precise vec4 by_u = float(n) * vec4(-rest.y, rest.y, part.y, -part.y);
        precise vec4 by_v = float(n) * vec4(-rest.x, -part.x, part.x, rest.x);
        return Changes(by_u, by_v);
    }
    precise float over = (part.x + part.y) - 1.0;
    if (over <= 0.0 || i + j + 2u > n) {
        return Changes(float(n) * vec4(-1.0, 1.0, 0.0, 0.0), float(n) * vec4(-1.0, 0.0, 1.0, 0.0));
    }
    return Changes(float(n) * vec4(1.0, -1.0, 0.0, 0.0), float(n) * vec4(1.0, 0.0, -1.0, 0.0));
}

#endif
