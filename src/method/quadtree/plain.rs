//! Plain edges and vertices: smooth, with four quads around each vertex. They need no plans; B-splines whose sums are symmetric give the same
//! bits to all faces around them.

use crate::plan::SmoothQuads;

/// Whether a vertex is plain.
pub fn is_plain(smooth: &SmoothQuads<'_>, vertex: u32) -> bool {
    smooth.valence(vertex) == Some(4)
}

/// The nine vertices around a plain vertex, row by row, in the frame of a corner: u runs to the next vertex and v to the previous one.
fn block(smooth: &SmoothQuads<'_>, face: u32, corner: u32) -> [[u32; 3]; 3] {
    let mut sides = [4 * face + corner; 4];
    for i in 1..4 {
        sides[i] = smooth.around(sides[i - 1]);
    }
    let end = |i: usize| smooth.vertex_after(sides[i], 1);
    let far = |i: usize| smooth.vertex_after(sides[i], 2);
    let own = smooth.vertex_after(sides[0], 0);
    [
        [far(2), end(3), far(3)],
        [end(2), own, end(0)],
        [far(1), end(1), far(0)],
    ]
}

/// The vertices around a plain edge, number x + 4 y, u along the face's edge from its corner on. Row 3 has no weight there.
pub fn edge_rows(smooth: &SmoothQuads<'_>, face: u32, corner: u32) -> [u32; 16] {
    let near = block(smooth, face, corner);
    // The other corner's frame is turned by a quarter: its u runs into the face, its v back along the edge.
    let far = block(smooth, face, (corner + 1) % 4);
    let row = |y: usize| [near[y][0], near[y][1], far[1][y], far[0][y]];
    [row(0), row(1), row(2), row(1)]
        .concat()
        .try_into()
        .expect("four rows of four")
}

/// The vertices around a plain vertex, number x + 4 y, in the frame of a corner, or in one turned by a quarter. Column and row 3 have no
/// weight there.
pub fn vertex_rows(smooth: &SmoothQuads<'_>, face: u32, corner: u32, turned: bool) -> [u32; 16] {
    let block = block(smooth, face, corner);
    std::array::from_fn(|i| {
        let [x, y] = [i % 4, i / 4].map(|i| if i == 3 { 1 } else { i });
        if turned { block[x][2 - y] } else { block[y][x] }
    })
}
