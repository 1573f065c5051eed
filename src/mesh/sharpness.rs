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
    let sum = sum(edges.iter().copied().filter(|&s| is_semi_sharp(s)));
    let next = |&sharpness: &f32| {
        if method == CreaseMethod::Uniform || semi_sharp < 2 || !is_semi_sharp(sharpness) {
            return decayed(sharpness);
        }
        let others = (sum - sharpness) / (semi_sharp - 1) as f32;
        decayed(0.75 * sharpness + 0.25 * others)
    };
    edges.iter().map(next).collect()
}

/// The sum in an order of its own: faces that list the edges of a vertex in different orders must find the same bits.
pub fn sum(values: impl Iterator<Item = f32>) -> f32 {
    let mut values: SmallVec<[f32; 8]> = values.collect();
    values.sort_unstable_by(f32::total_cmp);
    values.iter().sum()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sharpness_loses_one_a_level_unless_it_is_infinite() {
        assert_eq!([3.5, 1.0, 0.25, 0.0].map(decayed), [2.5, 0.0, 0.0, 0.0]);
        assert_eq!(decayed(INFINITE_SHARPNESS), INFINITE_SHARPNESS);
        let levels = std::iter::successors(Some(9.9), |&s| is_sharp(s).then(|| decayed(s)));
        assert_eq!(
            levels.count(),
            11,
            "what is semi-sharp is gone after ten levels"
        );
    }

    #[test]
    fn chaikins_rule_takes_a_quarter_of_the_others() {
        let around = |edges: &[f32]| decayed_around_vertex(CreaseMethod::Chaikin, edges).to_vec();
        assert_eq!(around(&[4.0, 2.0]), [2.5, 1.5]);
        assert_eq!(around(&[4.0, 2.0, 6.0, 0.0]), [3.0, 1.75, 4.25, 0.0]);
        assert_eq!(
            around(&[4.0, INFINITE_SHARPNESS]),
            [3.0, INFINITE_SHARPNESS]
        );
        assert_eq!(around(&[4.0, 0.0]), [3.0, 0.0]);
        let uniform = decayed_around_vertex(CreaseMethod::Uniform, &[4.0, 2.0]);
        assert_eq!(uniform[..], [3.0, 1.0]);
    }

    #[test]
    fn chaikins_rule_does_not_depend_on_the_order_of_edges() {
        let edges = [5.3954, 2.1, 4.61873, 0.7, 3.33];
        let expected = decayed_around_vertex(CreaseMethod::Chaikin, &edges);
        for turn in 1..edges.len() {
            let (mut turned, mut next) = (edges, expected.clone());
            turned.rotate_left(turn);
            next.rotate_left(turn);
            assert_eq!(decayed_around_vertex(CreaseMethod::Chaikin, &turned), next);
        }
    }

    #[test]
    fn rules_follow_from_sharp_edges_unless_the_vertex_is_sharp() {
        let rules = [0, 1, 2, 3, 4].map(|edges| rule(0.0, edges));
        use Rule::{Corner, Crease, Dart, Smooth};
        assert_eq!(rules, [Smooth, Dart, Crease, Corner, Corner]);
        assert_eq!(rule(0.5, 0), Corner);
    }
}
