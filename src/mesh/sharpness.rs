//! How sharpness decays, and which rule it makes a vertex follow (DeRose, Kass, Truong 1998; OpenSubdiv's `Sdc::Crease`).
//!
//! Sharpness is f32 as in OBJ tags and in OpenSubdiv, so that "has decayed to zero" means the same in both.

use smallvec::SmallVec;

use crate::mesh::{CreaseMethod, INFINITE_SHARPNESS};

/// Whether a sharpness never decays.
pub fn is_infinite(sharpness: f32) -> bool {
    sharpness >= INFINITE_SHARPNESS
}

/// Whether a sharpness makes its edge or vertex sharp at this level.
pub fn is_sharp(sharpness: f32) -> bool {
    sharpness > 0.0
}

/// Whether a sharpness is there now and will be gone.
pub fn is_semi_sharp(sharpness: f32) -> bool {
    is_sharp(sharpness) && !is_infinite(sharpness)
}

/// The sharpness one level on.
pub fn decayed(sharpness: f32) -> f32 {
    if is_infinite(sharpness) {
        sharpness
    } else {
        (sharpness - 1.0).max(0.0)
    }
}

/// The sharpness one level on of the edges around a vertex, each at this vertex's end.
///
/// Chaikin's rule takes three quarters of an edge's sharpness and one quarter of the mean of the other semi-sharp edges' before it decays.
pub fn decayed_around_vertex(method: CreaseMethod, edges: &[f32]) -> SmallVec<[f32; 8]> {
    let semi_sharp = edges.iter().filter(|&&s| is_semi_sharp(s)).count();
    let sum: f32 = edges.iter().filter(|&&s| is_semi_sharp(s)).sum();
    let next = |&sharpness: &f32| {
        if method == CreaseMethod::Uniform || semi_sharp < 2 || !is_semi_sharp(sharpness) {
            return decayed(sharpness);
        }
        let others = (sum - sharpness) / (semi_sharp - 1) as f32;
        decayed(0.75 * sharpness + 0.25 * others)
    };
    edges.iter().map(next).collect()
}

/// Which mask refines a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// No sharp edge.
    Smooth,
    /// One sharp edge ends here; refined as smooth.
    Dart,
    /// Two sharp edges pass through.
    Crease,
    /// Three or more sharp edges, or a sharp vertex: it stays where it is.
    Corner,
}

/// The rule of a vertex of this sharpness on so many sharp edges.
pub fn rule(vertex: f32, sharp_edges: usize) -> Rule {
    match sharp_edges {
        _ if is_sharp(vertex) => Rule::Corner,
        0 => Rule::Smooth,
        1 => Rule::Dart,
        2 => Rule::Crease,
        _ => Rule::Corner,
    }
}
