//! Where patches are, and what an edit that fails takes back.

use std::num::NonZeroU32;
use std::ops::Range;

use crate::abi;
use crate::method::Pass;

/// The passes, in their order: regular patches, patches with plans and short rings, patches with plans and long rings.
pub const PASSES: usize = 3;

/// Where the patch of a ptex face is: pass and slot, in one word, since there are millions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place(NonZeroU32);

impl Place {
    /// The bits of a pass' number, which counts from one.
    const PASS: u32 = 2;

    /// A slot of a pass.
    pub fn new(pass: usize, slot: u32) -> Place {
        let word = slot << Self::PASS | (pass as u32 + 1);
        Place(NonZeroU32::new(word).expect("passes count from one"))
    }

    /// The number of its pass.
    pub fn pass(self) -> usize {
        (self.0.get() & ((1 << Self::PASS) - 1)) as usize - 1
    }

    /// Its slot there.
    pub fn slot(self) -> u32 {
        self.0.get() >> Self::PASS
    }
}

/// What can be taken back, and what is let go at the end.
#[derive(Default)]
pub struct Log {
    /// What was in slots before, in the order in which they were changed.
    pub before: Vec<Before>,
    /// Numbers of control vertices: pass, start, count.
    pub freed: Vec<(usize, u32, u32)>,
    /// By pass, where numbers of control vertices were written below the end of the list.
    pub written: [Vec<Range<u32>>; PASSES],
}

/// What was in a slot: its patch, texture coordinates and sides.
pub struct Before {
    pub place: Place,
    patch: abi::Patch,
    texture: [[f32; 2]; 4],
    sides: [u32; 4],
}

impl Log {
    /// Takes down what is in a slot.
    pub fn remember(&mut self, pass: &Pass, place: Place) {
        let slot = place.slot() as usize;
        self.before.push(Before {
            place,
            patch: pass.patches[slot],
            texture: pass.texture[slot],
            sides: pass.sides.get(slot).copied().unwrap_or_default(),
        });
    }

    /// Puts everything back, in passes that had so many slots.
    pub fn take_back(self, passes: &mut [Pass], slots: &[usize]) {
        for before in self.before.into_iter().rev() {
            let (pass, slot) = (
                &mut passes[before.place.pass()],
                before.place.slot() as usize,
            );
            pass.patches[slot] = before.patch;
            pass.texture[slot] = before.texture;
            if let Some(sides) = pass.sides.get_mut(slot) {
                *sides = before.sides;
            }
        }
        for (pass, &slots) in passes.iter_mut().zip(slots) {
            pass.patches.truncate(slots);
            pass.texture.truncate(slots);
            pass.sides.truncate(slots);
        }
    }
}
