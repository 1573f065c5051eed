//! The normals of vertices, as the control shader decides them: which sums of tangents are directions, and which are rounding. Twin of
//! `glsl/lib/tangents.glsl`.
//!
//! Who shares a vertex's tangent plane decides from the same numbers in the same order, and so gets the same bits.

use glam::Vec3;

use crate::abi;
use crate::method::quadtree::twin::{Use, compensated_sum, spoke};
use crate::method::surface::{Controls, Tangents, UNIT, reach};
use crate::plan::Row;

/// Sums over a ring. Compensated, they err by some units of rounding of the absolute sum; the ring's own positions by one each.
fn tangents(
    given: &Controls,
    ring: &[u32],
    origin: Vec3,
    [first, second]: [Row<'_>; 2],
) -> Tangents {
    let spokes = || ring.iter().map(|&vertex| spoke(given, vertex, origin));
    let one = |row: Row<'_>| {
        let weighted = || {
            spokes()
                .enumerate()
                .map(|(i, spoke)| (row.weight(i), spoke))
        };
        let terms = weighted().map(|(weight, spoke)| weight * spoke);
        let (mut spread, mut total) = (0.0, 0.0);
        for (weight, spoke) in weighted() {
            spread += weight.abs() * reach(spoke);
            total += weight.abs();
        }
        let error = UNIT * (4.0 * spread + reach(origin) * total);
        (compensated_sum(terms), error)
    };
    let ((du, error_u), (dv, error_v)) = (one(first), one(second));
    Tangents {
        sums: [du, dv],
        errors: [error_u, error_v],
    }
}

impl Use<'_> {
    /// The normal at a corner of the patch.
    pub(super) fn vertex_normal(&self, given: &Controls, flags: u32) -> Vec3 {
        let nearby = match self.border.used(self.number).root {
            abi::NO_TANGENTS => None,
            number => {
                let normal = self.of(0).tangents(given, number).normal();
                // The plan's tangents go the other way round there.
                let mirrored = self.border.is_mirrored();
                Some(if mirrored { -normal } else { normal })
            }
        };
        if flags & abi::USE_CUSP != 0 {
            return nearby.unwrap_or(Vec3::ZERO);
        }
        let pair = 1 + 2 * (flags >> abi::USE_SIDE_SHIFT);
        let tangents = self.tangents(given, pair);
        let limit = tangents.normal();
        match nearby {
            None if limit == Vec3::ZERO && flags & abi::USE_SPARE != 0 => {
                self.tangents(given, pair + 2).normal()
            }
            None => limit,
            Some(nearby) => {
                let firm = tangents.are_firm() && Tangents::are_near(limit, nearby);
                if nearby == Vec3::ZERO || firm {
                    limit
                } else {
                    nearby
                }
            }
        }
    }

    /// Another use of the same patch.
    fn of(&self, number: usize) -> Use<'_> {
        Use { number, ..*self }
    }

    /// The pair of tangents whose first is stencil `number` of the use's plan.
    fn tangents(&self, given: &Controls, number: u32) -> Tangents {
        let ring: Vec<u32> = self.vertices().collect();
        tangents(
            given,
            &ring,
            self.origin(given),
            [number, number + 1].map(|number| self.stencil(number)),
        )
    }
}
