//! Depth tags: how deeply the surface is to be refined around each control vertex (Boubekeur, Schlick 2007, section 3.2).

use glam::{Mat4, Vec3, Vec4};

use crate::abi;
use crate::error::Result;
use crate::method::Outline;

/// A depth for each control vertex: 2 to the depth is the level of the edges around it, the greater one of two tags' an edge's. So both faces
/// of an edge have the same level there, and levels change smoothly as the tags do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DepthTags {
    /// By control vertex, 0..=10; a list's levels are at most its cut's.
    pub depths: Vec<f32>,
    /// By ptex face, 0..=10, where the insides of patches are to be deeper than their edges ask for; those that lack have none. Edges keep their levels, and
    /// neighbours theirs. For the tessellator; other back-ends cut by edges alone.
    pub insides: Vec<f32>,
}

impl DepthTags {
    /// The deepest: level 1024.
    pub const DEEPEST: f32 = abi::HIGHEST_LEVEL as f32;

    /// By what is wanted of each vertex; what is no number, or beyond what tessellators do, is clamped.
    pub fn new(depths: impl IntoIterator<Item = f32>) -> DepthTags {
        DepthTags {
            depths: depths.into_iter().map(clamped).collect(),
            insides: Vec::new(),
        }
    }

    /// The same with depths of the insides of ptex faces.
    pub fn with_insides(self, insides: impl IntoIterator<Item = f32>) -> DepthTags {
        DepthTags {
            insides: insides.into_iter().map(clamped).collect(),
            ..self
        }
    }

    /// View-dependent, by the distance of [limits](Outline::limits) from the eye: `greatest` up to the distance `near`, and one less whenever the distance doubles.
    ///
    /// # Errors
    /// [`Misuse::Count`](crate::Misuse::Count) for other than one position a control vertex.
    pub fn by_distance(
        outline: &Outline,
        vertices: &[Vec3],
        eye: Vec3,
        near: f32,
        greatest: f32,
    ) -> Result<DepthTags> {
        let farther = |vertex: &Vec3| {
            let distance = vertex.as_dvec3().distance(eye.as_dvec3());
            (distance / f64::from(near)).max(1.0).log2() as f32
        };
        let limits = outline.limits(vertices)?;
        let depths = limits.iter().map(|limit| greatest - farther(limit));
        Ok(DepthTags::new(depths))
    }

    /// View-dependent, by what is seen of [limits](Outline::limits): such that the segments of the edges around a vertex are at most `pixels` long in a picture
    /// of `size` pixels, wherever they point to. What lies at the eye or behind it is refined to the end.
    ///
    /// # Errors
    /// [`Misuse::Count`](crate::Misuse::Count) for other than one position a control vertex.
    pub fn by_screen(
        outline: &Outline,
        vertices: &[Vec3],
        clip_from_model: [[f32; 4]; 4],
        size: [f32; 2],
        pixels: f32,
    ) -> Result<DepthTags> {
        let limits = outline.limits(vertices)?;
        let clip = Mat4::from_cols_array_2d(&clip_from_model);
        let scale = |row: Vec4, size: f32| 0.5 * size * row.truncate().length();
        let pixels_per_unit = scale(clip.row(0), size[0]).max(scale(clip.row(1), size[1]));
        let tags = DepthTags::by_edges(outline, vertices.len(), |from, to| {
            let [from, to] = [from, to].map(|vertex| limits[vertex as usize]);
            let w = clip.row(3).dot(from.extend(1.0)).max(f32::MIN_POSITIVE);
            (from.distance(to) * pixels_per_unit / w / pixels).log2()
        });
        Ok(tags)
    }

    /// View-independent, by the curvature: such that from one end of a segment to the other normals turn by at most `degrees`.
    ///
    /// # Errors
    /// [`Misuse::Count`](crate::Misuse::Count) for other than one position a control vertex.
    pub fn by_curvature(outline: &Outline, vertices: &[Vec3], degrees: f32) -> Result<DepthTags> {
        outline.check_count("positions", vertices.len())?;
        let normals = outline.normals(vertices);
        let tags = DepthTags::by_edges(outline, vertices.len(), |from, to| {
            let [a, b] = [from, to].map(|vertex| normals[vertex as usize]);
            let angle = 2.0 * (a - b).length().atan2((a + b).length());
            (angle.to_degrees() / degrees).log2()
        });
        Ok(tags)
    }

    /// The greatest depth that an edge at a vertex wants, from one end to the other.
    fn by_edges(outline: &Outline, vertices: usize, depth: impl Fn(u32, u32) -> f32) -> DepthTags {
        let mut depths = vec![0.0f32; vertices];
        for &[a, b] in outline.edges() {
            for (from, to) in [(a, b), (b, a)] {
                let own = &mut depths[from as usize];
                *own = own.max(depth(from, to));
            }
        }
        DepthTags::new(depths)
    }
}

fn clamped(depth: f32) -> f32 {
    match depth.is_nan() {
        true => 0.0,
        false => depth.clamp(0.0, DepthTags::DEEPEST),
    }
}
