//! Batches: runs of patches, or of sub-patches, that fit into the scratch ring together, and into whatever else bounds a draw.

use std::ops::Range;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::sub_patches::{Drawn, has_sub_patches, sub_patches};
use crate::frame::{Backend, Cut};
use crate::method::{Pass, Prepared};

/// Patches of a pass that are drawn at once: full instances, with no patch over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Run {
    /// The pass.
    pub pass: usize,
    /// The first patch.
    pub first: u32,
    /// Patches an instance.
    pub per_instance: u32,
    /// Instances.
    pub instances: u32,
    /// Points that its patches need in the ring.
    pub points: u32,
    /// Vertices that are captured of its patches; fewer where depth tags lower their levels.
    pub vertices: u32,
    /// Which of the runs that use the ring this is.
    pub ring_batch: u32,
}

impl Run {
    /// Its patches.
    pub fn patches(&self) -> Range<u32> {
        self.first..self.first + self.per_instance * self.instances
    }
}

/// What bounds a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bounds {
    /// Points in the ring, where there is one.
    pub ring: Option<u32>,
    /// Vertices.
    pub vertices: u32,
    /// Who makes them.
    pub backend: Backend,
    /// Tessellated vertices an instance, on drivers that bound them.
    pub instance_vertices: Option<u32>,
}

/// Cuts what is drawn of all passes into batches within the bounds, at a cut as the backend makes it.
///
/// # Errors
/// [`Misuse::RingTooSmall`] when one patch alone needs more points than the ring has.
pub(super) fn batches<'a>(
    drawn: impl IntoIterator<Item = Drawn<'a>>,
    bounds: Bounds,
) -> Result<Vec<Run>> {
    let mut runs = Vec::new();
    let mut ring_batch = 0;
    for (number, drawn) in drawn.into_iter().enumerate() {
        let most = bounds.patches_per_instance(drawn);
        let Range { start, end } = drawn.range();
        let mut first = start as u32;
        while (first as usize) < end {
            let mut run = Run {
                pass: number,
                ring_batch,
                ..bounds.longest(drawn, first as usize..end)?
            };
            bounds.trim(&mut run, drawn, most);
            ring_batch += u32::from(bounds.uses_ring(drawn.pass));
            first = run.patches().end;
            runs.push(run);
        }
    }
    Ok(runs)
}

impl Bounds {
    /// Whether patches of a pass take slots in the ring.
    pub fn uses_ring(&self, pass: &Pass) -> bool {
        self.ring.is_some() && !pass.scratch_points.is_empty()
    }

    /// How many patches an instance may hold: of those that are cut finest.
    fn patches_per_instance(&self, drawn: Drawn<'_>) -> u32 {
        let Some(most) = self.instance_vertices else {
            return u32::MAX;
        };
        let levels = (0..drawn.count()).filter_map(|number| drawn.levels(number));
        let segments = levels.map(|levels| levels.greatest_segments(drawn.cut.spacing));
        patches_per_instance(most, segments.max().unwrap_or(1))
    }

    /// As many of some patches, from the first on, as fit, one at least; as one instance.
    fn longest(&self, drawn: Drawn<'_>, patches: Range<usize>) -> Result<Run> {
        let mut run = Run {
            pass: 0,
            first: patches.start as u32,
            per_instance: 0,
            instances: 1,
            points: 0,
            vertices: 0,
            ring_batch: 0,
        };
        for patch in patches {
            let [points, vertices] = self.needs(drawn, patch);
            let room = self.ring.unwrap_or(0);
            if points > room {
                return Err(Error::Misuse(Misuse::RingTooSmall {
                    needed: 16 * u64::from(points),
                    given: 16 * u64::from(room),
                }));
            }
            let fits = run.points + points <= room
                && run.vertices.saturating_add(vertices) <= self.vertices;
            if run.per_instance > 0 && !fits {
                break;
            }
            run.per_instance += 1;
            run.points += points;
            run.vertices += vertices;
        }
        Ok(run)
    }

    /// Leaves out the last patches that would make an instance by themselves: two draws that use the ring would need a barrier between them,
    /// since synchronization is a matter of whole buffers.
    fn trim(&self, run: &mut Run, drawn: Drawn<'_>, most: u32) {
        let end = run.patches().end;
        [run.per_instance, run.instances] = full_instances(run.per_instance, most);
        for patch in run.patches().end..end {
            let [points, vertices] = self.needs(drawn, patch as usize);
            run.points -= points;
            run.vertices -= vertices;
        }
    }

    /// Points and vertices of a patch, or of a piece.
    pub fn needs(&self, drawn: Drawn<'_>, number: usize) -> [u32; 2] {
        let (levels, spacing) = (drawn.levels(number), drawn.cut.spacing);
        let vertices = levels.map_or(0, |levels| self.backend.evaluations(&levels, spacing));
        let points = match self.uses_ring(drawn.pass) {
            true => drawn.points(number),
            false => 0,
        };
        [points, vertices]
    }
}

/// How many quad patches, each cut into `segments` x `segments` cells, an instance of at most `most` vertices may hold. At least 1, which is
/// always right: 65 x 65 vertices are far below any limit.
pub(super) fn patches_per_instance(most: u32, segments: u32) -> u32 {
    (most / ((segments + 1) * (segments + 1))).max(1)
}

/// Patches an instance, `most` at most, and full instances of `patches`. What is over is less than `most`: so where a run of the greatest
/// length ends, two trimmed ones have ended, since the second begins less than `most` before that and either holds what is left in one
/// instance, or more.
fn full_instances(patches: u32, most: u32) -> [u32; 2] {
    let instances = patches.div_ceil(most);
    if instances <= most {
        [patches / instances, instances]
    } else {
        [most, patches / most]
    }
}

/// The greatest number of batches that use the ring, whatever the cut up to the greatest level. Runs of the greatest length are the fewer the
/// lower the level is, and trimmed ones are at most twice as many; see [`full_instances`].
///
/// # Errors
/// As [`batches`].
pub(super) fn most_ring_batches(
    prepared: &Prepared,
    cuts: [Cut; 2],
    bounds: Bounds,
) -> Result<u32> {
    let whole = Bounds {
        instance_vertices: None,
        ..bounds
    };
    let mut most = 0;
    for cut in cuts {
        let cut = bounds.backend.cut(cut);
        let passes = prepared.passes.iter();
        let cuts: Vec<_> = passes
            .clone()
            .map(|pass| sub_patches_at(pass, cut))
            .collect();
        let drawn = passes.zip(&cuts).map(|(pass, sub_patches)| Drawn {
            pass,
            cut,
            tagged: None,
            sub_patches: sub_patches.as_deref(),
        });
        let runs = batches(drawn, whole)?;
        let ring = |run: &&Run| whole.uses_ring(&prepared.passes[run.pass]);
        most = most.max(runs.iter().filter(ring).count() as u32);
    }
    Ok(most * (1 + u32::from(bounds.instance_vertices.is_some())))
}

/// The sub-patches of a pass at a cut, the same for all of it; None where patches are drawn whole.
fn sub_patches_at(pass: &Pass, cut: Cut) -> Option<Vec<abi::SubPatch>> {
    has_sub_patches(cut.level).then(|| sub_patches(pass, |patch| cut.levels(pass, patch)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instances_stay_below_the_limit_and_waste_nothing() {
        for segments in 1..=64 {
            let patches = patches_per_instance(65_535, segments);
            let vertices = (segments + 1) * (segments + 1);
            assert!(patches * vertices <= 65_535);
            assert!((patches + 1) * vertices > 65_535);
        }
        assert_eq!(patches_per_instance(1, 64), 1);
    }

    #[test]
    fn full_instances_leave_less_over_than_one_holds() {
        for most in [1, 2, 3, 15, 64, 809, u32::MAX] {
            for patches in (1..3000).chain([100_000, 1 << 20]) {
                let [per_instance, instances] = full_instances(patches, most);
                assert!(per_instance <= most && instances > 0 && per_instance > 0);
                let over = patches - per_instance * instances;
                assert!(over < most, "{patches} {most}");
                assert!(2 * over < patches, "{patches} {most}");
            }
        }
    }
}
