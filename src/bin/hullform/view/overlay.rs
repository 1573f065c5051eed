//! Lines over the scene, projected by the host: the control cage, what is picked, and the frozen camera. Each line is as wide as its pixels say.

use glam::{DMat4, DVec2, DVec3, DVec4};
use hullform::host::ColouredVertex;

use super::part::Part;
use super::selection::Selection;
use super::stage::background;
use super::viewer::Viewer;
use super::viewport::Area;
use crate::output::picture::to_linear;

/// Towards the eye, in depths: over what lies at the same place.
const BEFORE: f64 = 4e-4;
/// The farthest depth of a line: before the background.
const FARTHEST: f64 = 1.0 - 1e-6;
/// The nearest that a line is drawn before the eye, as a share of the farthest end's way.
const NEAR: f64 = 1e-3;
/// The colour of edges without a crease.
const PLAIN: [f32; 3] = [0.12, 0.13, 0.15];
/// The colour of what is picked.
const PICKED: [f32; 3] = [1.0, 0.62, 0.05];
/// The colour of the frozen camera.
const FROZEN: [f32; 3] = [0.25, 0.65, 1.0];

/// Vertices and triangles.
pub type Mesh = (Vec<ColouredVertex>, Vec<[u32; 3]>);

/// What is drawn besides surfaces.
#[derive(Clone, Debug, Default)]
pub struct Overlay {
    /// Background and lines.
    pub vertices: Vec<ColouredVertex>,
    /// Their triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Maps of errors, one a side.
    pub maps: Vec<Mesh>,
    /// The sides and parts that they are of.
    pub mapped: Vec<(usize, u64)>,
}

/// Draws lines and dots of so many pixels.
struct Pen<'a> {
    overlay: &'a mut Overlay,
    clip: DMat4,
    /// Half of the picture's size in pixels.
    half: DVec2,
    /// Pixels of a point.
    scale: f64,
}

impl Overlay {
    /// What the viewer shows, in an area of the window; `scale` is the pixels of a point.
    pub fn new(viewer: &Viewer, area: Area, scale: f64) -> Overlay {
        let (vertices, triangles) = background();
        let mut overlay = Overlay {
            vertices: vertices.into(),
            triangles: triangles.into(),
            ..Overlay::default()
        };
        let all = viewer.sphere();
        let mut pen = Pen {
            clip: viewer.orbit.eye().clip_from_world(area.aspect(), all),
            half: 0.5 * DVec2::new(f64::from(area.width), f64::from(area.height)),
            scale,
            overlay: &mut overlay,
        };
        for part in &viewer.parts {
            let own = viewer.selection.part() == Some(part.number());
            if viewer.look.cage {
                pen.cage(part);
            }
            if own {
                pen.selection(part, &viewer.selection);
            }
        }
        if let Some(frozen) = &viewer.frozen {
            pen.frustum(frozen.eye().clip_from_world(area.aspect(), all));
        }
        overlay
    }
}

impl Pen<'_> {
    fn cage(&mut self, part: &Part) {
        let (Some(model), Some(history)) = (&part.model, part.history()) else {
            return;
        };
        let (points, draft) = (part.points(), history.draft());
        if points.len() != model.mesh().vertex_count() {
            return;
        }
        for edge in model.topology().edges() {
            let [a, b] = edge.vertices;
            let key = super::draft::edge_key(a, b);
            let sharpness = draft.creases.get(&key).copied().unwrap_or(0.0);
            let ends = [points[a as usize], points[b as usize]];
            let width = if sharpness > 0.0 { 2.4 } else { 1.1 };
            self.line(ends, width, crease_colour(sharpness));
        }
        for (vertex, &point) in points.iter().enumerate() {
            let sharpness = draft.corners.get(&(vertex as u32)).copied().unwrap_or(0.0);
            let size = if sharpness > 0.0 { 7.0 } else { 4.0 };
            self.dot(point, size, crease_colour(sharpness));
        }
    }

    fn selection(&mut self, part: &Part, selection: &Selection) {
        let points = part.points();
        let at = |vertex: u32| points.get(vertex as usize).copied();
        for &[a, b] in &selection.edges {
            if let (Some(a), Some(b)) = (at(a), at(b)) {
                self.line([a, b], 4.0, PICKED);
            }
        }
        for &vertex in &selection.vertices {
            if let Some(point) = at(vertex) {
                self.dot(point, 9.0, PICKED);
            }
        }
        let Some(model) = &part.model else { return };
        let faces = selection
            .faces
            .iter()
            .filter(|&&face| (face as usize) < model.mesh().face_count());
        for &face in faces {
            let corners = model.mesh().face(face as usize);
            let next = corners.iter().cycle().skip(1);
            for (&a, &b) in corners.iter().zip(next) {
                if let (Some(a), Some(b)) = (at(a), at(b)) {
                    self.line([a, b], 4.0, PICKED);
                }
            }
        }
    }

    /// What another camera sees, from its nearest to its farthest plane.
    fn frustum(&mut self, clip: DMat4) {
        let back = clip.inverse();
        if !back.is_finite() {
            return;
        }
        let corner = |i: usize| {
            let sign = |bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            back.project_point3(DVec3::new(sign(0), sign(1), (i >> 2) as f64))
        };
        let edges = (0..8).flat_map(|i| [1, 2, 4].map(|bit| (i, i | bit)));
        for (a, b) in edges.filter(|(a, b)| a != b) {
            self.line([corner(a), corner(b)], 1.6, FROZEN);
        }
        // From where it looks, where that is a place.
        let eye = back * DVec4::Z;
        if eye.w.abs() > 1e-9 {
            let eye = eye.truncate() / eye.w;
            (0..4).for_each(|i| self.line([eye, corner(i)], 1.0, FROZEN));
        }
    }

    /// A line between two points, without what lies behind the eye.
    fn line(&mut self, ends: [DVec3; 2], width: f64, colour: [f32; 3]) {
        let [mut a, mut b] = ends.map(|end| self.clip * end.extend(1.0));
        let near = NEAR * a.w.max(b.w);
        if !near.is_finite() || near <= 0.0 {
            return;
        }
        let cut = |from: DVec4, to: DVec4| match from.w < near {
            true => from.lerp(to, (near - from.w) / (to.w - from.w)),
            false => from,
        };
        (a, b) = (cut(a, b), cut(b, a));
        let [from, to] = [a, b].map(|end| end.truncate().truncate() / end.w * self.half);
        let across = (to - from).normalize_or(DVec2::X).perp() * (0.5 * width * self.scale);
        let aside = across / self.half;
        self.quad([(a, -aside), (a, aside), (b, aside), (b, -aside)], colour);
    }

    /// A square of so many points.
    fn dot(&mut self, at: DVec3, size: f64, colour: [f32; 3]) {
        let clip = self.clip * at.extend(1.0);
        if clip.w <= 1e-12 || !clip.is_finite() {
            return;
        }
        let off = 0.5 * size * self.scale / self.half;
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        self.quad(corners.map(|(x, y)| (clip, off * DVec2::new(x, y))), colour);
    }

    fn quad(&mut self, corners: [(DVec4, DVec2); 4], [r, g, b]: [f32; 3]) {
        let first = self.overlay.vertices.len() as u32;
        for (clip, off) in corners {
            let mut moved = clip + (off * clip.w).extend(0.0).extend(0.0);
            // What lies nearer or farther than all surfaces is seen all the same.
            moved.z = (moved.z - BEFORE * clip.w).clamp(0.0, FARTHEST * clip.w);
            self.overlay.vertices.push(ColouredVertex {
                clip: moved.as_vec4().to_array(),
                colour: [r, g, b, 1.0],
            });
        }
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let triangles = triangles.map(|triangle| triangle.map(|i: u32| first + i));
        self.overlay.triangles.extend(triangles);
    }
}

/// Sharpness as a colour, in linear light: from none over yellow to red, which is infinite.
pub fn crease_colour(sharpness: f32) -> [f32; 3] {
    if sharpness <= 0.0 {
        return PLAIN.map(to_linear);
    }
    let t = (sharpness / 10.0).min(1.0);
    [1.0, 0.85 - 0.75 * t, 0.1].map(to_linear)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::{Eye, Lens, Sphere};

    fn pen(overlay: &mut Overlay) -> Pen<'_> {
        let eye = Eye {
            from: DVec3::ZERO,
            to: DVec3::NEG_Z,
            lens: Lens::Perspective(60.0),
        };
        let all = Sphere {
            centre: DVec3::new(0.0, 0.0, -2.0),
            radius: 1.5,
        };
        Pen {
            overlay,
            clip: eye.clip_from_world(1.0, all),
            half: DVec2::splat(50.0),
            scale: 1.0,
        }
    }

    #[test]
    fn lines_are_as_wide_as_they_say_and_end_before_the_eye() {
        let mut overlay = Overlay::default();
        let ends = [DVec3::new(0.0, 0.0, -2.0), DVec3::new(0.0, 1.0, 5.0)];
        pen(&mut overlay).line(ends, 3.0, PLAIN);
        assert_eq!(overlay.triangles.len(), 2);
        let at = |i: usize| {
            let clip = overlay.vertices[i].clip.map(f64::from);
            assert!(clip[3] > 0.0, "behind the eye");
            DVec2::new(clip[0], clip[1]) / clip[3] * 50.0
        };
        assert!((at(0).distance(at(1)) - 3.0).abs() < 1e-3);
        assert!((at(2).distance(at(3)) - 3.0).abs() < 1e-3);
        let mut none = Overlay::default();
        pen(&mut none).line([DVec3::Z, 2.0 * DVec3::Z], 3.0, PLAIN);
        pen(&mut none).dot(DVec3::Z, 3.0, PLAIN);
        assert!(none.vertices.is_empty());
    }

    #[test]
    fn sharper_is_redder() {
        let green = [0.5, 2.0, 9.0, 10.0, 99.0].map(|sharpness| crease_colour(sharpness)[1]);
        assert!(green.is_sorted_by(|a, b| a >= b) && green[3] == green[4]);
    }
}
