//! What is drawn where the device decides: of each view the patches that are not left out, in batches by what they need. Twin of `glsl/compact.comp`.
//!
//! Patches stay in their order. Where each begins in an endless ring is the sum of what those before it need; the ring is a window of it, and a batch draws what
//! begins in its window. Windows are shorter than the ring by what a patch can need at most, so that the last one fits: then no batch has to know where the one
//! before has ended, and all patches find theirs at once. Rejected: as many in a row as fit, for which one batch waits for the other; it fills the ring by a patch more.

use bytemuck::Zeroable;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::Cut;
use crate::frame::batches::{Bounds, Run, patches_per_instance};
use crate::frame::sub_patches::Drawn;
use crate::method::{Pass, Prepared};
use crate::tessellation::{Levels, Spacing, required_level};

/// Drivers that bound the vertices of an instance keep all of them in memory at once, and are the slower the more that is: of as many as llvmpipe takes, a frame took a third
/// longer than of an eighth.
const SHARE: u32 = 8;

/// How the patches of a pass are cut into batches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Compaction {
    /// How many batches are recorded: no view needs more, whatever is decided.
    pub batches: u32,
    /// How many points begin in a batch, or how many patches it has.
    pub window: u32,
    /// Points of each slot, where windows are of patches; None where they are of points.
    pub slot: Option<u32>,
    /// Tessellated vertices an instance, where the driver bounds them.
    pub instance_vertices: Option<u32>,
}

/// What a view draws of a pass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compacted {
    /// The patches that are drawn, in their order.
    pub list: Vec<u32>,
    /// The slots of these in the ring.
    pub slots: Vec<u32>,
    /// The batches, of these one after another; of those that are recorded the last may draw nothing.
    pub batches: Vec<abi::DrawnBatch>,
}

/// What the patches of a pass need at a cut, where everything is drawn.
#[derive(Default)]
struct Most {
    drawn: u32,
    points: u64,
    vertices: u64,
    /// Of a patch.
    slot: u32,
    evaluations: u32,
}

impl Compaction {
    /// For levels that are nowhere above a cut's; the runs are batches in which everything may be. None where there is no patch.
    ///
    /// # Errors
    /// [`Misuse::RingTooSmall`] when one patch alone needs more points than the ring has.
    pub(super) fn new(drawn: Drawn<'_>, bounds: Bounds) -> Result<Option<(Compaction, Run)>> {
        let most = bounds.most(drawn);
        let room = bounds.ring.unwrap_or(0);
        if most.slot > room {
            return Err(Error::Misuse(Misuse::RingTooSmall {
                needed: 16 * u64::from(most.slot),
                given: 16 * u64::from(room),
            }));
        }
        if most.drawn == 0 {
            return Ok(None);
        }
        let in_ring = room.checked_div(most.slot).unwrap_or(u32::MAX);
        let captured = bounds.vertices / most.evaluations.max(1);
        let patches = in_ring.min(captured).clamp(1, most.drawn);
        let by_patches = Compaction {
            batches: most.drawn.div_ceil(patches),
            window: patches,
            slot: Some(most.slot),
            instance_vertices: bounds.instance_vertices.map(|most| (most / SHARE).max(1)),
        };
        let window = room - most.slot + 1;
        let by_points = Compaction {
            batches: (1 + (most.points.max(1) - 1) / u64::from(window)) as u32,
            window,
            slot: None,
            ..by_patches
        };
        // Sums have 32 bits.
        let is_bounded = most.vertices > u64::from(bounds.vertices);
        let able = most.slot > 0 && !is_bounded && most.points < 1 << 32;
        let own = match able && by_points.batches <= by_patches.batches {
            true => by_points,
            false => by_patches,
        };
        let of_window = |all: u64, one: u32| match own.slot {
            Some(_) => all.min(u64::from(one) * u64::from(own.window)),
            None => all.div_ceil(u64::from(own.batches)),
        };
        let run = Run {
            pass: 0,
            first: 0,
            per_instance: drawn.count() as u32,
            instances: 1,
            points: of_window(most.points, most.slot) as u32,
            vertices: of_window(most.vertices, most.evaluations).min(u64::from(u32::MAX)) as u32,
            ring_batch: 0,
        };
        Ok(Some((own, run)))
    }

    /// What a view draws of a pass, by the levels that were decided in it.
    pub fn compacted(
        &self,
        pass: &Pass,
        decided: &[abi::PatchDraw],
        spacing: Spacing,
    ) -> Compacted {
        let mut made = Compacted::default();
        let mut firsts = vec![0];
        let (mut points, mut segments) = (0u32, 0);
        let drawn = decided.iter().enumerate();
        for (patch, record) in drawn.filter(|(_, record)| record.inside > 0.0) {
            let levels = levels_of(pass, patch, record);
            let rank = made.list.len() as u32;
            let place = if self.slot.is_some() { rank } else { points };
            while firsts.len() as u32 <= place / self.window {
                firsts.push(rank);
            }
            made.list.push(patch as u32);
            made.slots
                .push(place % self.window * self.slot.unwrap_or(1));
            points += pass.points(patch, required_level(&levels, abi::HIGHEST_LEVEL));
            segments = levels.greatest_segments(spacing).max(segments);
        }
        firsts.resize(self.batches as usize + 1, made.list.len() as u32);
        let most = self.instance_vertices.map_or(u32::MAX, |vertices| {
            patches_per_instance(vertices, segments)
        });
        let batch = |ends: &[u32]| {
            let patches = ends[1] - ends[0];
            let instances = patches.div_ceil(most);
            let per_instance = patches.div_ceil(instances.max(1));
            abi::DrawnBatch {
                instances,
                first: ends[0],
                patches,
                per_instance,
                ..abi::DrawnBatch::zeroed()
            }
        };
        made.batches = firsts.windows(2).map(batch).collect();
        made
    }
}

/// The levels of a patch that a device has decided.
fn levels_of(pass: &Pass, patch: usize, record: &abi::PatchDraw) -> Levels {
    Levels {
        domain: pass.domain,
        cells: crate::tessellation::cells(&pass.patches[patch]),
        edges: record.edges,
        inside: record.inside,
    }
}

impl Bounds {
    fn most(&self, drawn: Drawn<'_>) -> Most {
        let mut most = Most::default();
        for number in (0..drawn.count()).filter(|&number| drawn.levels(number).is_some()) {
            let [points, vertices] = self.needs(drawn, number);
            most.drawn += 1;
            most.points += u64::from(points);
            most.vertices += u64::from(vertices);
            most.slot = most.slot.max(points);
            most.evaluations = most.evaluations.max(vertices);
        }
        most
    }
}

/// The batches of all passes, all of each pass' alike, and how they come about.
///
/// # Errors
/// As [`Compaction::new`].
pub(super) fn compactions(
    prepared: &Prepared,
    cut: Cut,
    bounds: Bounds,
) -> Result<(Vec<Option<Compaction>>, Vec<Run>)> {
    let (mut all, mut runs, mut ring_batch) = (Vec::new(), Vec::new(), 0);
    for (number, pass) in prepared.passes.iter().enumerate() {
        let drawn = Drawn {
            pass,
            cut,
            tagged: None,
            sub_patches: None,
        };
        let made = Compaction::new(drawn, bounds)?;
        for _ in 0..made.iter().map(|(own, _)| own.batches).sum() {
            runs.extend(made.iter().map(|(_, run)| Run {
                pass: number,
                ring_batch,
                ..run.clone()
            }));
            ring_batch += u32::from(bounds.uses_ring(pass));
        }
        all.push(made.map(|(own, _)| own));
    }
    Ok((all, runs))
}

/// The greatest number of batches that each pass has, whatever the cut up to the greatest level: lower ones need less of everything.
///
/// # Errors
/// As [`Compaction::new`].
pub(crate) fn most_batches(
    prepared: &Prepared,
    cuts: [Cut; 2],
    bounds: Bounds,
) -> Result<Vec<u32>> {
    let mut most = vec![0; prepared.passes.len()];
    for cut in cuts {
        let (all, _) = compactions(prepared, bounds.backend.cut(cut), bounds)?;
        for (most, own) in most.iter_mut().zip(all) {
            *most = own.map_or(0, |own| own.batches).max(*most);
        }
    }
    Ok(most)
}
