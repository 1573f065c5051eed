//! A change of a control mesh, and the way back.

use std::collections::BTreeMap;

use glam::DVec3;

use super::EdgeKey;

/// A change, as it can be made and taken back: what was, and what is to be.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Of the sharpness of edges; None for no crease.
    Creases(BTreeMap<EdgeKey, [f32; 2]>),
    /// Of the sharpness of vertices.
    Corners(BTreeMap<u32, [f32; 2]>),
    /// Of whether faces are holes.
    Holes(BTreeMap<u32, [bool; 2]>),
    /// Of places.
    Positions(BTreeMap<u32, [DVec3; 2]>),
}

impl Change {
    /// The way back.
    pub(super) fn reversed(&self) -> Change {
        fn turned<K: Ord + Copy, V: Copy>(all: &BTreeMap<K, [V; 2]>) -> BTreeMap<K, [V; 2]> {
            all.iter().map(|(&key, &[a, b])| (key, [b, a])).collect()
        }
        match self {
            Change::Creases(all) => Change::Creases(turned(all)),
            Change::Corners(all) => Change::Corners(turned(all)),
            Change::Holes(all) => Change::Holes(turned(all)),
            Change::Positions(all) => Change::Positions(turned(all)),
        }
    }

    /// Takes a later change of the same things in, if it is one.
    pub(super) fn absorb(&mut self, later: &Change) -> bool {
        fn absorb<K: Ord + Copy, V: Copy>(
            first: &mut BTreeMap<K, [V; 2]>,
            later: &BTreeMap<K, [V; 2]>,
        ) -> bool {
            let same = first.keys().eq(later.keys());
            if same {
                for (own, other) in first.values_mut().zip(later.values()) {
                    own[1] = other[1];
                }
            }
            same
        }
        match (self, later) {
            (Change::Creases(a), Change::Creases(b)) => absorb(a, b),
            (Change::Corners(a), Change::Corners(b)) => absorb(a, b),
            (Change::Positions(a), Change::Positions(b)) => absorb(a, b),
            _ => false,
        }
    }

    /// How many things it changes.
    pub(super) fn size(&self) -> usize {
        match self {
            Change::Creases(all) => all.len(),
            Change::Corners(all) => all.len(),
            Change::Holes(all) => all.len(),
            Change::Positions(all) => all.len(),
        }
    }

    /// Whether nothing but places differ: plans do not depend on these.
    pub(super) fn is_of_positions(&self) -> bool {
        matches!(self, Change::Positions(_))
    }
}
