//! Random edits: of tags, and of faces.

use hullform::mesh::{Edit, Model};

/// Numbers without a pattern (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    pub fn below(&mut self, count: usize) -> u32 {
        (self.next() % count as u64) as u32
    }
}

/// A random step of tags; most are creases. What holes there were are mostly closed again, so that something is left.
pub fn step(edit: &mut Edit, model: &Model, random: &mut Random) {
    let sharpness = [0.0, 0.0, 0.5, 1.0, 2.0, 3.5, 10.0][random.below(7) as usize];
    let topology = model.topology();
    match random.below(8) {
        0 => edit.corner(random.below(topology.vertex_count()), sharpness),
        1 => {
            let face = random.below(topology.face_count());
            match model.mesh().is_removed(face as usize) {
                true => edit,
                false => edit.hole(face, true),
            }
        }
        2 => match model.mesh().holes() {
            [] => edit,
            holes => edit.hole(holes[random.below(holes.len()) as usize], false),
        },
        _ => {
            let edge = random.below(topology.edge_count());
            let [a, b] = topology.edges()[edge as usize].vertices;
            edit.crease(a, b, sharpness)
        }
    };
}

/// A random change of faces, which are to stay about as many: `most` at most, and vertices no more than so many.
///
/// A face is removed, extruded, cut into triangles around a new vertex, turned, or connected to another vertex nearby, which may make any edge one of three faces; or a
/// triangle is put beside an edge.
pub fn reshape(edit: &mut Edit, model: &Model, random: &mut Random, most: [usize; 2]) {
    let (mesh, topology) = (model.mesh(), model.topology());
    let there = |face: &usize| !mesh.is_removed(*face);
    let faces: Vec<usize> = (0..mesh.face_count()).filter(there).collect();
    let face = faces[random.below(faces.len()) as usize];
    let vertices = mesh.face(face).to_vec();
    let n = vertices.len();
    let centre = vertices.iter().fold([0.0; 3], |sum, &vertex| {
        let at = mesh.positions()[vertex as usize].to_array();
        std::array::from_fn(|i| sum[i] + at[i] / n as f64)
    });
    // Vertices that no face uses are used again.
    let unused = |&vertex: &u32| topology.vertex_faces(vertex).is_empty();
    let free: Vec<u32> = (0..mesh.vertex_count() as u32).filter(unused).collect();
    let is_full = faces.len() + n > most[0] || mesh.vertex_count() - free.len() + n > most[1];
    let mut free = free.into_iter();
    let mut next = mesh.vertex_count() as u32;
    let mut vertex = |edit: &mut Edit, at: [f64; 3]| {
        if let Some(vertex) = free.next() {
            edit.position(vertex, at);
            return vertex;
        }
        edit.add_vertex(at);
        next += 1;
        next - 1
    };
    let corner = random.below(n) as usize;
    match random.below(6) {
        0 if faces.len() + 60 > most[0] => _ = edit.remove_face(face as u32),
        1 if !is_full => {
            let lifted: Vec<u32> = vertices
                .iter()
                .map(|&own| {
                    let at = mesh.positions()[own as usize].to_array();
                    let lift = [0.0, 0.0, 0.5];
                    vertex(
                        edit,
                        std::array::from_fn(|i| 0.7 * at[i] + 0.3 * centre[i] + lift[i]),
                    )
                })
                .collect();
            for i in 0..n {
                let j = (i + 1) % n;
                edit.add_face(&[vertices[i], vertices[j], lifted[j], lifted[i]]);
            }
            edit.reconnect_face(face as u32, &lifted);
            edit.crease(lifted[0], lifted[1], 1.5);
        }
        2 if !is_full => {
            let middle = vertex(edit, centre);
            edit.remove_face(face as u32);
            for i in 0..n {
                edit.add_face(&[vertices[i], vertices[(i + 1) % n], middle]);
            }
        }
        3 => {
            let mut turned = vertices;
            turned.rotate_left(corner);
            edit.reconnect_face(face as u32, &turned);
        }
        4 => {
            let edge = topology.vertex_edges(vertices[corner]).last();
            let other = edge.map(|&edge| topology.edges()[edge as usize].other(vertices[corner]));
            if let Some(other) = other.filter(|other| !vertices.contains(other)) {
                let mut vertices = vertices;
                vertices[corner] = other;
                edit.reconnect_face(face as u32, &vertices);
            }
        }
        _ if !is_full => {
            let other = vertex(edit, centre.map(|x| x + 0.4));
            edit.add_face(&[vertices[(corner + 1) % n], vertices[corner], other]);
        }
        _ if faces.len() + 60 > most[0] => _ = edit.remove_face(face as u32),
        _ => {}
    }
}
