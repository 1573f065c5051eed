//! What every method's patches have in common: one a triangle or quad that the scheme takes whole, one a corner of other faces, with their
//! flags, valences and texture coordinates.

use crate::abi;
use crate::mesh::Model;
use crate::tessellation::Domain;

/// A patch to be: a face as a whole, or the part of an n-gon at a corner.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Its shape.
    pub domain: Domain,
    /// The face.
    pub face: u32,
    /// The n-gon's corner; 0 for whole faces.
    pub corner: u32,
    /// Its ptex number.
    pub ptex: u32,
}

/// The parts of every face that is no hole, in ptex order.
pub fn parts(model: &Model) -> Vec<Part> {
    let mut parts = Vec::with_capacity(model.mesh().ptex_count());
    parts.extend(each_part(model));
    parts
}

/// The same, one after another.
pub fn each_part(model: &Model) -> impl Iterator<Item = Part> {
    let mut next = 0;
    let faces = 0..model.topology().face_count() as u32;
    faces.flat_map(move |face| {
        let ptex = next;
        next += model.mesh().ptex_faces(face as usize) as u32;
        let is_drawn = !model.topology().is_hole(face);
        let all = is_drawn.then(|| parts_at(model, face, ptex));
        all.into_iter().flatten()
    })
}

/// The parts of those of some faces, in ascending order, that are no holes, and the ptex faces of the others, removed ones included.
pub fn parts_of(model: &Model, faces: &[u32]) -> (Vec<Part>, Vec<u32>) {
    let only_quads = model.topology().quads().is_some();
    let whole = only_quads && model.mesh().options().scheme.is_whole(4);
    let first = match whole {
        true => Vec::new(),
        false => model.mesh().ptex_offsets(),
    };
    let (mut parts, mut holes) = (Vec::new(), Vec::new());
    for &face in faces {
        let ptex = first.get(face as usize).copied().unwrap_or(face);
        let all = parts_at(model, face, ptex);
        match model.topology().is_hole(face) {
            true => holes.extend(ptex..ptex + model.mesh().ptex_faces(face as usize) as u32),
            false => parts.extend(all),
        }
    }
    (parts, holes)
}

/// The parts of a face whose first ptex number is known.
fn parts_at(model: &Model, face: u32, ptex: u32) -> impl ExactSizeIterator<Item = Part> {
    let arity = model.topology().face(face).len() as u32;
    let whole = model.mesh().options().scheme.is_whole(arity as usize);
    let domain = match arity {
        3 if whole => Domain::Triangles,
        _ => Domain::Quads,
    };
    (0..if whole { arity.min(1) } else { arity }).map(move |corner| Part {
        domain,
        face,
        corner,
        ptex: ptex + corner,
    })
}

/// The common fields of the patch of a part whose corner 0 is the quad's corner `turn`.
pub fn patch(model: &Model, part: Part, turn: u32) -> abi::Patch {
    let topology = model.topology();
    let vertices = topology.face(part.face);
    let (flags, valences) = if part.domain == Domain::Triangles {
        let valence = |corner: usize| topology.vertex_edges(vertices[corner]).len();
        (0, [valence(0), valence(1), valence(2), 0])
    } else if vertices.len() == 4 {
        let corners: [u32; 4] = std::array::from_fn(|i| (turn + i as u32) % 4);
        let edge = |corner: u32| topology.face_edges(part.face)[corner as usize];
        let whole = topology.quads().is_some() && model.mesh().options().scheme.is_whole(4);
        let sides = 0..if whole { 0 } else { 4 };
        let even = sides.filter(|&i| touches_parts(model, edge(corners[i])));
        let even: u32 = even.map(|i| abi::PATCH_EVEN_EDGE << i).sum();
        let valences = corners.map(|corner| topology.vertex_edges(vertices[corner as usize]).len());
        (even | turn << abi::PATCH_TURN_SHIFT, valences)
    } else {
        let corner = topology.vertex_edges(vertices[part.corner as usize]).len();
        (abi::PATCH_HALF, [corner, 4, vertices.len(), 4])
    };
    let bytes = valences.map(|valence| valence.min(255) as u8);
    abi::Patch {
        ptex: part.ptex,
        flags,
        valences: u32::from_le_bytes(bytes),
        ..Default::default()
    }
}

/// Whether a face at an edge is drawn in parts, each with half of its edges.
fn touches_parts(model: &Model, edge: u32) -> bool {
    let (topology, scheme) = (model.topology(), model.mesh().options().scheme);
    let mut faces = topology.edge_faces(edge).iter();
    faces.any(|&face| !scheme.is_whole(topology.face(face).len()) && !topology.is_hole(face))
}

/// The texture coordinates at the corners of a part, a triangle's last one twice, whose corner 0 is the quad's corner `turn`; without any, those of the ptex face.
pub fn texture(model: &Model, part: Part, turn: u32) -> [[f32; 2]; 4] {
    let own = match part.domain {
        Domain::Quads => [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        Domain::Triangles => [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0]],
    };
    let mesh = model.mesh();
    let corners = match mesh.texture() {
        None => own,
        Some(texture) => {
            let indices = &texture.indices[mesh.corner_range(part.face as usize)];
            let value = |&index: &u32| texture.values[index as usize];
            let (n, i) = (indices.len(), part.corner as usize);
            let middle = |other: usize| (value(&indices[i]) + value(&indices[other % n])) / 2.0;
            let corners = match *indices {
                [a, b, c, d] => [a, b, c, d].map(|index| value(&index)),
                [a, b, c] if part.domain == Domain::Triangles => {
                    [a, b, c, c].map(|index| value(&index))
                }
                _ => [
                    value(&indices[i]),
                    middle(i + 1),
                    indices.iter().map(value).sum::<glam::DVec2>() / n as f64,
                    middle(i + n - 1),
                ],
            };
            corners.map(|corner| corner.as_vec2().to_array())
        }
    };
    std::array::from_fn(|i| corners[(turn as usize + i) % 4])
}
