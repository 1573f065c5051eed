//! Random meshes in a plane: whatever is tagged, cut out or joined, their surfaces lie in that plane and have its normal.

use glam::{DMat3, DQuat, DVec3};
use hullform::mesh::{
    BoundaryInterpolation, ControlMesh, INFINITE_SHARPNESS, Scheme, SchemeOptions,
};

use super::meshes::scatter;

/// A mesh in a plane.
pub struct Planar {
    pub mesh: ControlMesh,
    /// Of the plane, on the side from which faces run counter-clockwise.
    pub normal: DVec3,
    /// The mesh was made from this number.
    pub seed: u64,
}

/// Numbers that follow from a seed.
struct Dice {
    seed: u64,
    thrown: u64,
}

impl Dice {
    /// In 0..1.
    fn share(&mut self) -> f64 {
        self.thrown += 1;
        0.5 + 0.5 * scatter(self.seed << 16 | self.thrown).x
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.share() * count as f64) as usize).min(count - 1)
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }
}

struct Draft {
    points: Vec<[f64; 2]>,
    faces: Vec<Vec<u32>>,
    creases: Vec<([u32; 2], f32)>,
    corners: Vec<(u32, f32)>,
}

/// A mesh in the plane z = 0 turned anywhere, a size of 2^-6 to 2^6 and up to eight sizes away from the origin; in one of eight cases it stays in z = 0.
pub fn planar(seed: u64, scheme: Scheme) -> Planar {
    let mut dice = Dice { seed, thrown: 0 };
    let mut draft = Draft::grid(&mut dice);
    for _ in 0..dice.below(5) {
        draft.stroke(&mut dice, scheme);
    }
    if scheme.is_triangular() {
        draft.triangulate(&mut dice);
    }
    for _ in 0..dice.below(5) {
        draft.tag(&mut dice, scheme != Scheme::Butterfly);
    }
    draft.placed(&mut dice, scheme, seed)
}

impl Draft {
    /// Cells of the unit square, straight in one of three cases.
    fn grid(dice: &mut Dice) -> Draft {
        let [columns, rows] = [0, 1].map(|_| 1 + dice.below(4));
        let shake = if dice.one_in(3) { 0.0 } else { 0.15 };
        let mut points = Vec::new();
        for y in 0..=rows {
            for x in 0..=columns {
                points.push([x, y].map(|i| i as f64 + shake * (2.0 * dice.share() - 1.0)));
            }
        }
        let number = |x: usize, y: usize| (x + (columns + 1) * y) as u32;
        let cells = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let faces = cells.map(|(x, y)| {
            vec![
                number(x, y),
                number(x + 1, y),
                number(x + 1, y + 1),
                number(x, y + 1),
            ]
        });
        Draft {
            points,
            faces: faces.collect(),
            creases: Vec::new(),
            corners: Vec::new(),
        }
    }

    fn stroke(&mut self, dice: &mut Dice, scheme: Scheme) {
        let face = dice.below(self.faces.len());
        match dice.below(5) {
            0 if self.faces.len() > 1 => {
                self.faces.remove(face);
            }
            1 => self.poke(face),
            2 if !scheme.is_triangular() => self.merge(face, dice),
            3 => self.faces[face].rotate_left(1),
            4 => self.slit(face, dice),
            _ => {}
        }
    }

    /// A vertex in the middle of a face, joined to all corners.
    fn poke(&mut self, face: usize) {
        let ring = self.faces.swap_remove(face);
        let sum = ring.iter().fold([0.0; 2], |sum, &v| {
            [0, 1].map(|i| sum[i] + self.points[v as usize][i] / ring.len() as f64)
        });
        self.points.push(sum);
        let middle = self.points.len() as u32 - 1;
        for i in 0..ring.len() {
            self.faces
                .push(vec![ring[i], ring[(i + 1) % ring.len()], middle]);
        }
    }

    /// Two quads become a hexagon with a straight corner on either side.
    fn merge(&mut self, face: usize, dice: &mut Dice) {
        let side = dice.below(4);
        let own = self.faces[face].clone();
        if own.len() != 4 {
            return;
        }
        let [a, b] = [own[side], own[(side + 1) % 4]];
        let beyond = self.faces.iter().position(|other| {
            other.len() == 4 && (0..4).any(|i| other[i] == b && other[(i + 1) % 4] == a)
        });
        let Some(beyond) = beyond else { return };
        let other = self.faces[beyond].clone();
        let at = other.iter().position(|&v| v == a).expect("it has both");
        let outer = [other[(at + 1) % 4], other[(at + 2) % 4]];
        let rest = [own[(side + 2) % 4], own[(side + 3) % 4]];
        self.faces[face] = vec![a, outer[0], outer[1], b, rest[0], rest[1]];
        self.faces.remove(beyond);
    }

    /// Parts two faces along their edge: both sides of the slit have a vertex of their own in one place.
    fn slit(&mut self, face: usize, dice: &mut Dice) {
        let corner = dice.below(self.faces[face].len());
        let vertex = self.faces[face][corner];
        // Half of the faces around, those that lie on one side of a line, get the other vertex.
        let at = self.points[vertex as usize];
        let twin = self.points.len() as u32;
        self.points.push(at);
        let points = &self.points;
        for face in &mut self.faces {
            let middle =
                face.iter().map(|&v| points[v as usize][1]).sum::<f64>() / face.len() as f64;
            if middle > at[1] {
                face.iter_mut()
                    .filter(|v| **v == vertex)
                    .for_each(|v| *v = twin);
            }
        }
    }

    fn triangulate(&mut self, dice: &mut Dice) {
        let mut triangles = Vec::new();
        for face in &mut self.faces {
            if face.len() == 4 && dice.one_in(2) {
                face.rotate_left(1);
            }
            for i in 1..face.len() - 1 {
                triangles.push(vec![face[0], face[i], face[i + 1]]);
            }
        }
        self.faces = triangles;
    }

    fn tag(&mut self, dice: &mut Dice, semi_sharp: bool) {
        let face = self.faces[dice.below(self.faces.len())].clone();
        let sharpness = if semi_sharp && dice.one_in(4) {
            3.0 * dice.share() as f32
        } else {
            INFINITE_SHARPNESS
        };
        let corner = dice.below(face.len());
        if dice.one_in(3) {
            return self.corners.push((face[corner], sharpness));
        }
        // One, two or three edges of a face: darts, creases that turn, and ends on others.
        for i in 0..1 + dice.below(3) {
            let edge = [
                face[(corner + i) % face.len()],
                face[(corner + i + 1) % face.len()],
            ];
            self.creases.push((edge, sharpness));
        }
    }

    fn placed(self, dice: &mut Dice, scheme: Scheme, seed: u64) -> Planar {
        let used: Vec<u32> = {
            let mut used = self.faces.concat();
            used.sort_unstable();
            used.dedup();
            used
        };
        let number = |v: u32| used.binary_search(&v).expect("it is used") as u32;
        let turn = match dice.one_in(8) {
            true => DMat3::IDENTITY,
            false => {
                let axis = scatter(seed ^ 0x5eed).normalize();
                DMat3::from_quat(DQuat::from_axis_angle(axis, 6.0 * dice.share()))
            }
        };
        let size = f64::from(dice.below(13) as u32 as i32 - 6).exp2();
        let shift = if dice.one_in(2) {
            8.0 * scatter(seed ^ 0xfa7)
        } else {
            DVec3::ZERO
        };
        let positions: Vec<[f64; 3]> = used
            .iter()
            .map(|&v| {
                let [x, y] = self.points[v as usize];
                (size * (turn * DVec3::new(x, y, 0.0) + shift)).to_array()
            })
            .collect();
        let sizes: Vec<u32> = self.faces.iter().map(|face| face.len() as u32).collect();
        let corners: Vec<u32> = self.faces.concat().into_iter().map(number).collect();
        let boundary = match dice.one_in(2) {
            true => BoundaryInterpolation::EdgeOnly,
            false => BoundaryInterpolation::EdgeAndCorner,
        };
        let options = SchemeOptions {
            boundary,
            scheme,
            ..SchemeOptions::default()
        };
        let mut builder = ControlMesh::builder(&positions, &sizes, &corners).options(options);
        for ([a, b], sharpness) in self.creases {
            builder = builder.crease(number(a), number(b), sharpness);
        }
        for (vertex, sharpness) in self.corners {
            builder = builder.corner(number(vertex), sharpness);
        }
        Planar {
            mesh: builder.build().expect("a sound mesh"),
            normal: turn * DVec3::Z,
            seed,
        }
    }
}
