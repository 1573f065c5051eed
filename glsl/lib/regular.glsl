// Faces that are one bicubic B-spline. Who includes it says where its control points are, number x + 4 y: REGULAR_POINT(i), and one of two where sums go along v
// first. Both may name `record`. Twin of `method/regular.rs`.
#ifndef REGULAR_GLSL
#define REGULAR_GLSL

#include "lib/border.glsl"
#include "lib/bspline.glsl"

// On edges the sums go along the edge first, at corners along the direction that the vertex prefers: so all faces there get the same bits. There are vertices at all
// four corners.
Surface regular_surface(Patch record, vec2 uv) {
    uint place = find_place(record.flags & ~PATCH_HALF, uv).number;
    bool turned = place >= 5u ? (record.flags & (PATCH_TURNED_CORNER << (place - 5u))) != 0u : place == 2u || place == 4u;
    vec2 t = turned_round(turned ? uv.y : uv.x, false);
    vec2 across = turned_round(turned ? uv.x : uv.y, false);
    Basis u = bspline_basis_of(t.x, t.y);
    Basis v = bspline_basis_of(across.x, across.y);
    Surface surface = bspline_surface(v, 1.0,
        bspline_row(u, REGULAR_POINT(0), REGULAR_PICK(turned, 1, 4), REGULAR_PICK(turned, 2, 8), REGULAR_PICK(turned, 3, 12)),
        bspline_row(u, REGULAR_PICK(turned, 4, 1), REGULAR_POINT(5), REGULAR_PICK(turned, 6, 9), REGULAR_PICK(turned, 7, 13)),
        bspline_row(u, REGULAR_PICK(turned, 8, 2), REGULAR_PICK(turned, 9, 6), REGULAR_POINT(10), REGULAR_PICK(turned, 11, 14)),
        bspline_row(u, REGULAR_PICK(turned, 12, 3), REGULAR_PICK(turned, 13, 7), REGULAR_PICK(turned, 14, 11), REGULAR_POINT(15)));
    return turned ? Surface(surface.position, surface.dv, surface.du) : surface;
}

#endif
