//! Patches and tables as the device reads them.

use rustc_hash::FxHashMap;

use crate::abi::{self, TableFace, TablePlace};
use crate::mesh::Model;
use crate::method::bft::lattice::Lattice;
use crate::method::bft::{Normals, Tables, domain, tangents, twin};
use crate::method::children::{Child, children};
use crate::method::{Pass, Table};
use crate::tessellation::Domain;

/// The passes of quads and of triangles, which may be empty.
pub fn passes(model: &Model, tables: &Tables) -> [Pass; 2] {
    let owners = Owners::new(tables);
    let children = children(model);
    [("bft_quads", Domain::Quads), ("bft", Domain::Triangles)].map(|(shader, domain)| {
        let mut packer = Packer {
            tables,
            pass: Pass::new(shader, domain, 1, twin).with_tangents(tangents),
            numbers: FxHashMap::default(),
            offsets: FxHashMap::default(),
            order: Vec::new(),
            faces: Vec::new(),
            weights: Vec::new(),
        };
        // Of faces, whose edges are two patches long.
        packer.pass.max_level = tables.level + 1;
        let faces = children.iter().filter(|child| child.part.domain == domain);
        for child in faces.clone() {
            packer.add(model, child);
        }
        let mut places = Vec::new();
        for child in faces {
            places.extend(packer.places(&owners, child.face));
        }
        packer.finish(&places)
    })
}

/// The first face that is drawn on each edge and at each vertex of the refined mesh, with its own side or corner there.
struct Owners {
    edges: Vec<Option<(u32, u32)>>,
    vertices: Vec<Option<(u32, u32)>>,
}

impl Owners {
    fn new(tables: &Tables) -> Owners {
        let topology = &tables.topology;
        let mut owners = Owners {
            edges: vec![None; topology.edge_count()],
            vertices: vec![None; topology.vertex_count()],
        };
        for face in (0..topology.face_count() as u32).filter(|&face| !topology.is_hole(face)) {
            for (side, &edge) in (0..).zip(topology.face_edges(face)) {
                owners.edges[edge as usize].get_or_insert((face, side));
            }
            for (corner, &vertex) in (0..).zip(topology.face(face)) {
                owners.vertices[vertex as usize].get_or_insert((face, corner));
            }
        }
        owners
    }
}

/// A pass as it is filled. Faces of its patches come first, in their order, then those of the other shape that own an edge or vertex.
struct Packer<'a> {
    tables: &'a Tables,
    pass: Pass,
    /// The number of each face.
    numbers: FxHashMap<u32, u32>,
    /// Where each kind's weights begin.
    offsets: FxHashMap<u32, u32>,
    /// The face of each number.
    order: Vec<u32>,
    faces: Vec<TableFace>,
    weights: Vec<f32>,
}

impl Packer<'_> {
    fn add(&mut self, model: &Model, child: &Child) {
        let turn = self.turn(child.face);
        let plan = self.number(child.face);
        let patch = abi::Patch {
            controls: self.faces[plan as usize].controls,
            plan,
            ..child.patch(&self.tables.topology, turn)
        };
        self.pass.texture.push(child.texture(model, &patch));
        self.pass.patches.push(patch);
    }

    /// By how many corners a face is turned.
    fn turn(&self, face: u32) -> u32 {
        let found = self.tables.configurations[face as usize].as_ref();
        found.map_or(0, |found| found.turn)
    }

    /// The number of a face, which is added if it is new.
    fn number(&mut self, face: u32) -> u32 {
        if let Some(&number) = self.numbers.get(&face) {
            return number;
        }
        let kind = self.tables.kinds[face as usize];
        let table = &self.tables.weights[kind as usize];
        let weights = *self.offsets.entry(kind).or_insert_with(|| {
            let first = self.weights.len() as u32;
            self.weights.extend_from_slice(table);
            first
        });
        let found = self.tables.configurations[face as usize].as_ref();
        let vertices = found.map_or(&[][..], |found| &found.vertices);
        let Lattice { corners, segments } =
            Lattice::new(domain(&self.tables.topology, face), self.tables.level);
        let number = self.faces.len() as u32;
        self.faces.push(TableFace {
            controls: self.pass.controls.len() as u32,
            count: vertices.len() as u32,
            weights,
            corners,
            segments,
            normals: number,
        });
        self.order.push(face);
        self.pass.controls.extend_from_slice(vertices);
        self.numbers.insert(face, number);
        number
    }

    /// Where a face's edges, then its vertices are evaluated, in the order of the patch's corners.
    fn places(&mut self, owners: &Owners, face: u32) -> Vec<TablePlace> {
        let topology = &self.tables.topology;
        let arity = topology.face(face).len() as u32;
        let turn = self.turn(face);
        let corners = (turn..turn + arity).map(|corner| (corner % arity) as usize);
        let edges = corners.clone().map(|side| {
            let edge = topology.face_edges(face)[side];
            let (owner, other) = owners.edges[edge as usize].unwrap_or((face, side as u32));
            let same = topology.face(face)[side] == topology.face(owner)[other as usize];
            (owner, other, if same { 0 } else { abi::PLACE_FLIPPED })
        });
        let vertices = corners.map(|corner| {
            let vertex = topology.face(face)[corner];
            let (owner, other) = owners.vertices[vertex as usize].unwrap_or((face, corner as u32));
            (owner, other, 0)
        });
        let all: Vec<(u32, u32, u32)> = edges.chain(vertices).collect();
        all.into_iter()
            .map(|(owner, side, flags)| {
                let arity = topology.face(owner).len() as u32;
                let side = (side + arity - self.turn(owner)) % arity;
                TablePlace {
                    face: self.number(owner),
                    side: side | flags,
                }
            })
            .collect()
    }

    /// Adds what normals come from, behind all faces.
    fn add_normals(&mut self) {
        let tables = self.tables;
        let (weights, flag) = match &tables.normals {
            Normals::Same => return,
            Normals::Tangents(weights) => (weights, abi::TABLE_TANGENTS),
            Normals::Refined(_, weights) => (weights, 0),
        };
        let mut offsets = FxHashMap::default();
        for (number, &face) in self.order.iter().enumerate() {
            let kind = tables.kinds[face as usize];
            let first = *offsets.entry(kind).or_insert_with(|| {
                let first = self.weights.len() as u32;
                self.weights.extend_from_slice(&weights[kind as usize]);
                first
            });
            let mut other = TableFace {
                weights: first,
                ..self.faces[number]
            };
            if let Normals::Refined(found, _) = &tables.normals {
                let found = found[face as usize].as_ref();
                let vertices = found.map_or(&[][..], |found| &found.vertices);
                other.controls = self.pass.controls.len() as u32;
                other.count = vertices.len() as u32;
                // Their points come behind those of the mesh refined once.
                let points = tables.topology.vertex_count() as u32;
                let numbers = vertices.iter().map(|vertex| points + vertex);
                self.pass.controls.extend(numbers);
            }
            self.faces[number].normals = self.faces.len() as u32 | flag;
            self.faces.push(other);
        }
    }

    fn finish(mut self, places: &[TablePlace]) -> Pass {
        self.add_normals();
        self.pass.tables = vec![
            Table::of(&self.weights),
            Table::of(&self.faces),
            Table::of(places),
        ];
        self.pass
    }
}
