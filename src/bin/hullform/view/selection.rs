//! What is picked of a control mesh: vertices, edges or faces of one model.

use std::collections::BTreeSet;

use glam::{DMat4, DVec2, DVec3};
use hullform::mesh::Model;

use super::draft::{EdgeKey, edge_key};

/// How near the mouse must be to a vertex or an edge, in points.
const NEAR: f64 = 9.0;

/// What a click picks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Nothing: clicks tell what is under the cursor.
    #[default]
    Look,
    /// Vertices.
    Vertices,
    /// Edges.
    Edges,
    /// Faces.
    Faces,
}

impl Tool {
    /// All of them.
    pub const ALL: [Tool; 4] = [Tool::Look, Tool::Vertices, Tool::Edges, Tool::Faces];

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Tool::Look => "look",
            Tool::Vertices => "vertices",
            Tool::Edges => "edges",
            Tool::Faces => "faces",
        }
    }
}

/// What is picked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// What a click picks.
    pub tool: Tool,
    part: Option<u64>,
    /// Vertices.
    pub vertices: BTreeSet<u32>,
    /// Edges.
    pub edges: BTreeSet<EdgeKey>,
    /// Faces.
    pub faces: BTreeSet<u32>,
}

/// One thing that was hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hit {
    /// A vertex.
    Vertex(u32),
    /// An edge.
    Edge(EdgeKey),
    /// A face.
    Face(u32),
}

impl Selection {
    /// Of which model, by its number.
    pub fn part(&self) -> Option<u64> {
        self.part
    }

    /// Picks nothing.
    pub fn clear(&mut self) {
        self.part = None;
        self.vertices.clear();
        self.edges.clear();
        self.faces.clear();
    }

    /// Whether nothing is picked.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty() && self.edges.is_empty() && self.faces.is_empty()
    }

    /// How many things are picked.
    pub fn count(&self) -> usize {
        self.vertices.len() + self.edges.len() + self.faces.len()
    }

    /// Picks what was hit: alone, or with what is picked, from which it goes where it was picked already.
    pub fn pick(&mut self, part: u64, hit: Option<Hit>, more: bool) {
        if !more || self.part != Some(part) {
            self.clear();
        }
        self.part = Some(part);
        fn turn<T: Ord>(all: &mut BTreeSet<T>, one: T) {
            if !all.remove(&one) {
                all.insert(one);
            }
        }
        match hit {
            None if !more => self.clear(),
            None => {}
            Some(Hit::Vertex(vertex)) => turn(&mut self.vertices, vertex),
            Some(Hit::Edge(edge)) => turn(&mut self.edges, edge),
            Some(Hit::Face(face)) => turn(&mut self.faces, face),
        }
    }
}

/// What sees a cage: from its units to clip space, and the picture's size in points.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// To clip space.
    pub clip: DMat4,
    /// The picture's size.
    pub size: DVec2,
}

impl Sight {
    /// Where a point is in the picture, from its left upper corner, and its depth; None behind the eye.
    pub fn place(&self, point: DVec3) -> Option<(DVec2, f64)> {
        let clip = self.clip * point.extend(1.0);
        if clip.w <= 1e-12 {
            return None;
        }
        let at = clip.truncate() / clip.w;
        Some((0.5 * (at.truncate() + 1.0) * self.size, at.z))
    }
}

/// What of a model's cage is at a place of the picture: the nearest to the eye of what is near enough, with its depth.
pub fn hit(
    tool: Tool,
    model: &Model,
    points: &[DVec3],
    sight: Sight,
    at: DVec2,
) -> Option<(Hit, f64)> {
    let places: Vec<_> = points.iter().map(|&point| sight.place(point)).collect();
    let mesh = model.mesh();
    if places.len() != mesh.vertex_count() {
        return None;
    }
    match tool {
        Tool::Look => None,
        Tool::Vertices => nearest((0..).zip(&places).filter_map(|(vertex, place)| {
            let (place, depth) = (*place)?;
            let near = place.distance(at) <= NEAR;
            near.then_some((Hit::Vertex(vertex), place.distance(at), depth))
        })),
        Tool::Edges => nearest(model.topology().edges().iter().filter_map(|edge| {
            let [a, b] = edge.vertices;
            let ((from, start), (to, end)) = (places[a as usize]?, places[b as usize]?);
            let share = along(from, to, at);
            let distance = from.lerp(to, share).distance(at);
            let depth = start + share * (end - start);
            (distance <= NEAR).then_some((Hit::Edge(edge_key(a, b)), distance, depth))
        })),
        Tool::Faces => nearest((0..).zip(mesh.faces()).filter_map(|(number, face)| {
            let corners: Option<Vec<_>> = face.iter().map(|&v| places[v as usize]).collect();
            let depth = depth_at(&corners?, at)?;
            Some((Hit::Face(number), 0.0, depth))
        })),
    }
}

/// The nearest to the eye, and among those at about one depth the nearest to the mouse.
fn nearest(hits: impl Iterator<Item = (Hit, f64, f64)>) -> Option<(Hit, f64)> {
    let cost = |&(_, distance, depth): &(Hit, f64, f64)| depth + 1e-4 * distance;
    let best = hits.min_by(|a, b| cost(a).total_cmp(&cost(b)));
    best.map(|(hit, _, depth)| (hit, depth))
}

/// The share of a segment at which it is nearest to a point.
fn along(from: DVec2, to: DVec2, at: DVec2) -> f64 {
    let way = to - from;
    let square = way.length_squared();
    if square > 0.0 {
        ((at - from).dot(way) / square).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// The depth of a polygon at a place, as a fan of triangles; None beside it.
fn depth_at(corners: &[(DVec2, f64)], at: DVec2) -> Option<f64> {
    let (&first, rest) = corners.split_first()?;
    let depths = rest.windows(2).filter_map(|pair| {
        let [(a, da), (b, db), (c, dc)] = [first, pair[0], pair[1]];
        let area = (b - a).perp_dot(c - a);
        let [u, v] = [
            (at - a).perp_dot(c - a) / area,
            (b - a).perp_dot(at - a) / area,
        ];
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        inside.then_some(da + u * (db - da) + v * (dc - da))
    });
    depths.min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::Sphere;
    use crate::view::orbit::Orbit;
    use hullform::mesh::builtin;

    #[test]
    fn what_is_in_front_is_hit_at_the_place_where_it_is_seen() {
        let model = Model::new(builtin("cube").expect("a cube"));
        let points = model.mesh().positions().to_vec();
        let mut orbit = Orbit::default();
        orbit.fit(points.iter().copied(), 1.0);
        let all = Sphere::around(points.iter().copied());
        let sight = Sight {
            clip: orbit.eye().clip_from_world(1.0, all),
            size: DVec2::splat(500.0),
        };
        let from = orbit.eye().from;
        let nearest = (0..8u32).min_by(|&a, &b| {
            let distance = |v: u32| points[v as usize].distance(from);
            distance(a).total_cmp(&distance(b))
        });
        let vertex = nearest.expect("eight vertices");
        let (place, _) = sight.place(points[vertex as usize]).expect("it is seen");
        let found = hit(Tool::Vertices, &model, &points, sight, place);
        assert_eq!(found.map(|(hit, _)| hit), Some(Hit::Vertex(vertex)));
        let face = hit(Tool::Faces, &model, &points, sight, DVec2::splat(250.0));
        let Some((Hit::Face(face), _)) = face else {
            panic!("a face is in the middle");
        };
        assert!(model.mesh().face(face as usize).contains(&vertex));
        let nothing = hit(Tool::Edges, &model, &points, sight, DVec2::splat(1.0));
        assert_eq!(nothing, None);
    }

    #[test]
    fn a_click_picks_one_thing_and_with_more_it_turns() {
        let mut selection = Selection::default();
        selection.pick(1, Some(Hit::Vertex(3)), false);
        selection.pick(1, Some(Hit::Vertex(4)), true);
        assert_eq!(selection.count(), 2);
        selection.pick(1, Some(Hit::Vertex(3)), true);
        assert_eq!(selection.vertices, [4].into());
        selection.pick(2, Some(Hit::Vertex(3)), true);
        assert_eq!((selection.count(), selection.part()), (1, Some(2)));
        selection.pick(2, None, false);
        assert!(selection.is_empty());
    }
}
