//! Where a patch lies in its ptex face: the whole of it or a child, turned or not.

use glam::Vec3;

use crate::abi;
pub(super) use crate::tessellation::Piece;

/// Where (u, v) of a patch's own domain lies in its ptex face: the patch may be one of its children, and its domain may be turned.
pub fn to_ptex(patch: &abi::Patch, uv: [f32; 2]) -> [f32; 2] {
    let [u, v] = turned_back(patch, uv);
    match child(patch) {
        Child::Whole => [u, v],
        Child::Corner(corner) => {
            let [x, y] = corner_uv(patch, corner);
            [0.5 * (u + x), 0.5 * (v + y)]
        }
        Child::Middle => [0.5 * (1.0 - u), 0.5 * (1.0 - v)],
        Child::Piece(piece) => {
            let [x, y] = piece.place();
            [piece.size() * (x + u), piece.size() * (y + v)]
        }
    }
}

/// Where (u, v) of a ptex face lies in the patch's own domain; outside of it where another child has the point.
pub fn from_ptex(patch: &abi::Patch, uv: [f32; 2]) -> [f32; 2] {
    let [u, v] = uv;
    let own = match child(patch) {
        Child::Whole => [u, v],
        Child::Corner(corner) => {
            let [x, y] = corner_uv(patch, corner);
            [2.0 * u - x, 2.0 * v - y]
        }
        Child::Middle => [1.0 - 2.0 * u, 1.0 - 2.0 * v],
        Child::Piece(piece) => {
            let [x, y] = piece.place();
            let pieces = (1u32 << piece.depth) as f32;
            [pieces * u - x, pieces * v - y]
        }
    };
    turned(patch, own)
}

/// Which part of its ptex face a patch is.
pub(super) enum Child {
    Whole,
    /// At this corner.
    Corner(usize),
    /// In the middle of a triangle, with its corners opposite to the triangle's.
    Middle,
    Piece(Piece),
}

pub(super) fn child(patch: &abi::Patch) -> Child {
    match patch.flags >> abi::PATCH_CHILD_SHIFT & 15 {
        0 => Child::Whole,
        number if number < abi::CHILD_OF_TRIANGLE => {
            Child::Corner((number - abi::CHILD_OF_QUAD) as usize)
        }
        abi::CHILD_PIECE => Child::Piece(Piece::of_plan(patch.plan)),
        number => match number - abi::CHILD_OF_TRIANGLE {
            corner @ 0..3 => Child::Corner(corner as usize),
            _ => Child::Middle,
        },
    }
}

/// Where a corner of a patch's ptex face is.
fn corner_uv(patch: &abi::Patch, corner: usize) -> [f32; 2] {
    match turn(patch) {
        (_, true) => [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]][corner],
        (_, false) => [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][corner],
    }
}

/// By how many corners the patch's domain is turned against its face, and whether it is a triangle's. Whole triangles are not turned.
fn turn(patch: &abi::Patch) -> (u32, bool) {
    let child = patch.flags >> abi::PATCH_CHILD_SHIFT & 15;
    let turn = patch.flags >> abi::PATCH_TURN_SHIFT & 3;
    let of_triangle = abi::CHILD_OF_TRIANGLE..abi::CHILD_PIECE;
    (turn, of_triangle.contains(&child))
}

fn turned_back(patch: &abi::Patch, [u, v]: [f32; 2]) -> [f32; 2] {
    match turn(patch) {
        (0, _) => [u, v],
        (1, true) => [(1.0 - u) - v, u],
        (_, true) => [v, (1.0 - u) - v],
        (1, false) => [1.0 - v, u],
        (2, false) => [1.0 - u, 1.0 - v],
        (_, false) => [v, 1.0 - u],
    }
}

fn turned(patch: &abi::Patch, [u, v]: [f32; 2]) -> [f32; 2] {
    match turn(patch) {
        (0, _) => [u, v],
        (1, true) => [v, (1.0 - u) - v],
        (_, true) => [(1.0 - u) - v, u],
        (1, false) => [v, 1.0 - u],
        (2, false) => [1.0 - u, 1.0 - v],
        (_, false) => [1.0 - v, u],
    }
}

/// Derivatives by a patch's own (u, v) as those by its ptex face's. Twin of `glsl/lib/ptex.glsl`.
pub(super) fn to_ptex_tangents(patch: &abi::Patch, [u, v]: [Vec3; 2]) -> [Vec3; 2] {
    let turned = match turn(patch) {
        (0, _) => [u, v],
        (1, true) => [-v, u - v],
        (_, true) => [v - u, -u],
        (1, false) => [-v, u],
        (2, false) => [-u, -v],
        (_, false) => [v, -u],
    };
    let scale = match child(patch) {
        Child::Whole => 1.0,
        Child::Corner(_) => 2.0,
        Child::Middle => -2.0,
        Child::Piece(piece) => 1.0 / piece.size(),
    };
    turned.map(|tangent| scale * tangent)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a plane that is linear in the face's own (u, v).
    #[test]
    fn tangents_follow_children_and_turns() {
        let (du, dv) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(-2.0, 1.0, 0.5));
        for child in 0..=8u32 {
            let turns = match child {
                ..abi::CHILD_OF_TRIANGLE => 4,
                _ => 3,
            };
            for turn in 0..turns {
                let patch = abi::Patch {
                    flags: child << abi::PATCH_CHILD_SHIFT | turn << abi::PATCH_TURN_SHIFT,
                    ..Default::default()
                };
                let at = |uv| {
                    let [u, v] = to_ptex(&patch, uv);
                    u * du + v * dv
                };
                let own = [
                    at([1.0, 0.0]) - at([0.0, 0.0]),
                    at([0.0, 1.0]) - at([0.0, 0.0]),
                ];
                assert_eq!(to_ptex_tangents(&patch, own), [du, dv], "{child} {turn}");
            }
        }
    }

    #[test]
    fn pieces_lead_to_the_ptex_face_and_back() {
        let mut piece = Piece::default();
        for corner in [1, 2, 3, 0, 2, 2] {
            piece = piece.child(corner);
            let patch = abi::Patch {
                flags: abi::CHILD_PIECE << abi::PATCH_CHILD_SHIFT,
                plan: piece.plan(),
                ..Default::default()
            };
            assert_eq!(Piece::of_plan(patch.plan), piece);
            for uv in [[0.0, 0.0], [0.25, 0.5], [1.0, 0.0], [0.0, 1.0]] {
                assert_eq!(from_ptex(&patch, to_ptex(&patch, uv)), uv);
            }
        }
        assert_eq!((piece.column, piece.row), (0b110011, 0b011011));
    }

    #[test]
    fn children_and_turns_lead_to_the_ptex_face_and_back() {
        for child in 0..=8u32 {
            let turns = if child >= abi::CHILD_OF_TRIANGLE {
                3
            } else {
                4
            };
            for turn in 0..turns {
                let patch = abi::Patch {
                    flags: child << abi::PATCH_CHILD_SHIFT | turn << abi::PATCH_TURN_SHIFT,
                    ..Default::default()
                };
                for uv in [[0.0, 0.0], [0.25, 0.5], [1.0, 0.0], [0.0, 1.0]] {
                    assert_eq!(from_ptex(&patch, to_ptex(&patch, uv)), uv);
                }
            }
        }
    }
}
