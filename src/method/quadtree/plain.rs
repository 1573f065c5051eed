//! Plain edges and vertices: smooth, with four quads around each vertex. They need no plans; B-splines whose sums are symmetric give the same
//! bits to all faces around them.

use crate::mesh::topology::Topology;

/// Whether sums at a plain vertex go first along the edge that enters the corner, instead of the one that leaves it: along those two of the
/// vertex's edges that have the lowest number.
pub fn is_turned_corner(topology: &Topology, face: u32, corner: u32) -> bool {
    let vertex = topology.face(face)[corner as usize];
    let edges = topology.face_edges(face);
    let [leaving, entering] = [corner, corner + 3].map(|i| edges[i as usize % 4]);
    let lowest = topology.vertex_edges(vertex).iter().copied().min();
    let lowest = lowest.expect("a vertex has edges");
    if lowest == leaving || lowest == entering {
        return lowest == entering;
    }
    // Beyond the edge that enters lies a face with the one that goes on from the edge that leaves.
    let mut beyond = topology.walk(vertex, face, entering);
    let (beyond, _) = beyond.next().expect("four quads are around the vertex");
    !topology.face_edges(beyond).contains(&lowest)
}

/// The nine vertices around a plain vertex, row by row, in the frame of a corner: u runs to the next vertex and v to the previous one.
fn block(topology: &Topology, face: u32, corner: u32) -> [[u32; 3]; 3] {
    let fan = topology.fan(face, corner);
    let end = |i: usize| topology.edge(fan.edges[(fan.at + i) % 4]).other(fan.vertex);
    let far = |i: usize| {
        let vertices = topology.face(fan.faces[(fan.at + i) % 4]);
        let own = vertices.iter().position(|&vertex| vertex == fan.vertex);
        vertices[(own.expect("the fan's faces touch its vertex") + 2) % 4]
    };
    [
        [far(2), end(3), far(3)],
        [end(2), fan.vertex, end(0)],
        [far(1), end(1), far(0)],
    ]
}

/// The vertices around a plain edge, number x + 4 y, u along the face's edge from its corner on. Row 3 has no weight there.
pub fn edge_rows(topology: &Topology, face: u32, corner: u32) -> [u32; 16] {
    let near = block(topology, face, corner);
    // The other corner's frame is turned by a quarter: its u runs into the face, its v back along the edge.
    let far = block(topology, face, (corner + 1) % 4);
    let row = |y: usize| [near[y][0], near[y][1], far[1][y], far[0][y]];
    [row(0), row(1), row(2), row(1)]
        .concat()
        .try_into()
        .expect("four rows of four")
}

/// The vertices around a plain vertex, number x + 4 y, in the frame of a corner, or in one turned by a quarter. Column and row 3 have no
/// weight there.
pub fn vertex_rows(topology: &Topology, face: u32, corner: u32, turned: bool) -> [u32; 16] {
    let block = block(topology, face, corner);
    std::array::from_fn(|i| {
        let [x, y] = [i % 4, i / 4].map(|i| if i == 3 { 1 } else { i });
        if turned { block[x][2 - y] } else { block[y][x] }
    })
}
