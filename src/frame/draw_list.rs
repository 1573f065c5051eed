//! What is drawn of a surface in a frame: batches in their order, the draws that each consists of, and what the host decides about patches.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::batches::{Run, batches, most_ring_batches};
use crate::frame::compaction::{Compaction, compactions, most_batches};
use crate::frame::patterns::Patterns;
use crate::frame::sub_patches::{Drawn, all_sub_patches, has_sub_patches, join, levels_of};
use crate::frame::tagged::Tagged;
use crate::frame::{Cut, Decides, Draw, Residence, SurfaceOptions};
use crate::method::{DepthTags, MacroFaces, Prepared};
use crate::tessellation::{Levels, Piece, Spacing};

/// What one frame decided about one surface: a plain value that is built without a device, and can be kept as long as its cut and tags stay.
///
/// It belongs to what was prepared and to the options that it was made with: a surface of other ones refuses it.
#[derive(Clone, Debug)]
pub struct DrawList {
    pub(super) number: u64,
    /// The number and version of what was prepared.
    prepared: [u64; 2],
    options: SurfaceOptions,
    instance_vertices: Option<u32>,
    cut: Cut,
    cached_level: Option<u32>,
    runs: Vec<Run>,
    /// By pass, where the device decides.
    pub(super) compactions: Vec<Option<Compaction>>,
    ring_batches: u32,
    /// By run.
    draws: Vec<Vec<Draw>>,
    /// By pass and patch, where depth tags are given, or some are chosen; level 0 where nothing is drawn.
    pub(super) tagged: Option<Vec<Vec<Levels>>>,
    /// How often the mesh is refined around each irregularity, of methods that go as deep as a frame needs.
    depths: Option<Vec<u32>>,
    records: Vec<Vec<abi::PatchDraw>>,
    /// By pass, where patches may be cut before they are drawn.
    pub(super) sub_patches: Option<Vec<Vec<abi::SubPatch>>>,
    instances: Vec<Vec<u32>>,
    patterns: Vec<Levels>,
}

impl DrawList {
    /// Decides how what was prepared is drawn at a cut, with a depth for each control vertex if there are tags: they lower levels; none is above
    /// the cut's. Some drivers bound the tessellated vertices of an instance: `instance_vertices`, see `gpu::workaround`.
    ///
    /// # Errors
    /// [`Misuse`] when options and cut do not go together, the ring cannot hold a single patch, or a tag is no depth or belongs to no vertex.
    pub fn new(
        prepared: &Prepared,
        options: &SurfaceOptions,
        instance_vertices: Option<u32>,
        cut: Cut,
        tags: Option<&DepthTags>,
    ) -> Result<DrawList> {
        options.check(prepared)?;
        let cut = options.cut(cut)?;
        check_macro_faces(prepared, cut)?;
        let bounds = options.bounds(instance_vertices);
        if tags.is_some() && options.decides == Decides::Device {
            let what = "depth tags";
            return Err(Error::Misuse(Misuse::DecidedByDevice { what }));
        }
        let tagged = match (tags, options.decides) {
            (Some(tags), _) => Some(Tagged::by_tags(prepared, options.backend, cut, tags)?),
            (None, Decides::Host) => Tagged::by_cut(prepared, cut),
            (None, Decides::Device) => None,
        };
        let (tagged, depths) = tagged.map(|own| (own.levels, own.depths)).unzip();
        let of_cut = || prepared.depths_at(|_| cut.level);
        let depths = prepared.is_dynamic().then(|| depths.unwrap_or_else(of_cut));
        let cut_first =
            has_sub_patches(cut.level).then(|| all_sub_patches(prepared, cut, tagged.as_deref()));
        let passes = prepared.passes.iter().enumerate();
        let (by_tags, by_pieces) = (tagged.as_ref(), cut_first.as_ref());
        let each = passes.map(|(number, pass)| Drawn {
            pass,
            cut,
            tagged: by_tags.map(|all: &Vec<Vec<Levels>>| all[number].as_slice()),
            sub_patches: by_pieces.map(|all| all[number].as_slice()),
        });
        let (compactions, runs) = match options.decides {
            Decides::Host => (Vec::new(), batches(each, bounds)?),
            Decides::Device => compactions(prepared, cut, bounds)?,
        };
        let uses_ring = |run: &&Run| bounds.uses_ring(&prepared.passes[run.pass]);
        let mut list = DrawList {
            number: new_number(),
            prepared: [prepared.number(), prepared.version()],
            options: *options,
            instance_vertices,
            cut,
            cached_level: (options.residence == Residence::Cache)
                .then(|| cut.cached_level(prepared)),
            ring_batches: runs.iter().filter(uses_ring).count() as u32,
            draws: Vec::new(),
            tagged,
            depths,
            records: Vec::new(),
            sub_patches: cut_first,
            instances: Vec::new(),
            patterns: Vec::new(),
            compactions,
            runs,
        };
        list.decide(prepared);
        Ok(list)
    }

    /// The counters that a surface needs for all of its batches that use the ring, in all rounds, at any cut that its options allow.
    ///
    /// # Errors
    /// As [`DrawList::new`].
    pub fn ring_counters(
        prepared: &Prepared,
        options: &SurfaceOptions,
        instance_vertices: Option<u32>,
    ) -> Result<u64> {
        options.check(prepared)?;
        let (bounds, cuts) = (options.bounds(instance_vertices), options.greatest_cuts());
        let most = match options.decides {
            Decides::Host => most_ring_batches(prepared, cuts, bounds)?,
            Decides::Device => {
                let all = most_batches(prepared, cuts, bounds)?.into_iter();
                let ringed = all.zip(&prepared.passes);
                ringed
                    .filter(|(_, pass)| bounds.uses_ring(pass))
                    .map(|(own, _)| own)
                    .sum()
            }
        };
        Ok(u64::from(most) * u64::from(options.rounds))
    }

    /// The counters that its own batches need, in all rounds.
    #[cfg(feature = "vulkan")]
    pub(crate) fn counters(&self) -> u64 {
        u64::from(self.ring_batches) * u64::from(self.options.rounds)
    }

    /// Fills in draws, and what the host decides about each patch where it does.
    pub(super) fn decide(&mut self, prepared: &Prepared) {
        (self.draws, self.records, self.instances) = Default::default();
        let records =
            self.sub_patches.is_none() && (self.options.has_host_slots() || self.tagged.is_some());
        let patterns = self.options.backend.has_patterns();
        let mut all = Patterns::default();
        for pass in &prepared.passes {
            let room = |wanted: bool| if wanted { pass.patches.len() } else { 0 };
            self.records.push(Vec::with_capacity(room(records)));
            self.instances.push(Vec::with_capacity(room(patterns)));
        }
        for number in 0..self.runs.len() {
            let run = self.runs[number].clone();
            self.give_slots(prepared, &run);
            // Those before the first that is drawn have places too.
            let before = run.first as usize;
            if records {
                let decided = self.decided(prepared, &run);
                self.records[run.pass].resize(before, abi::PatchDraw::default());
                self.records[run.pass].extend(decided);
            }
            if patterns {
                let levels = |patch| self.levels(prepared, run.pass, patch);
                let (draws, instances) = all.arrange(run.patches(), levels);
                self.instances[run.pass].resize(before, 0);
                self.instances[run.pass].extend(instances);
                self.draws.push(draws);
            } else if self.options.decides == Decides::Device {
                let first = self.runs.iter().position(|own| own.pass == run.pass);
                let batch = (number - first.unwrap_or(number)) as u32;
                self.draws.push(vec![Draw::Decided { batch }]);
            } else {
                self.draws.push(vec![Draw::Patches {
                    first: run.first,
                    per_instance: run.per_instance,
                    instances: run.instances,
                }]);
            }
        }
        self.patterns = all.all;
    }

    /// What is drawn of a pass.
    fn drawn<'a>(&'a self, prepared: &'a Prepared, pass: usize) -> Drawn<'a> {
        Drawn {
            pass: &prepared.passes[pass],
            cut: self.cut,
            tagged: self.tagged.as_ref().map(|all| all[pass].as_slice()),
            sub_patches: self.sub_patches.as_ref().map(|all| all[pass].as_slice()),
        }
    }

    /// The slots of what a run draws: they follow one another.
    fn slots(&self, prepared: &Prepared, run: &Run) -> Vec<u32> {
        let drawn = self.drawn(prepared, run.pass);
        let mut next = 0;
        let slot = |number: u32| {
            let slot = next;
            next += drawn.points(number as usize);
            slot
        };
        run.patches().map(slot).collect()
    }

    /// Gives the sub-patches of a run their slots, where there are sub-patches.
    fn give_slots(&mut self, prepared: &Prepared, run: &Run) {
        let slots = match self.sub_patches {
            Some(_) => self.slots(prepared, run),
            None => return,
        };
        let own = self.sub_patches.iter_mut().map(|all| &mut all[run.pass]);
        for own in own {
            let drawn = run.patches().start as usize..run.patches().end as usize;
            for (sub_patch, slot) in own[drawn].iter_mut().zip(&slots) {
                sub_patch.slot = *slot;
            }
        }
    }

    /// The records of a run's patches.
    fn decided(&self, prepared: &Prepared, run: &Run) -> Vec<abi::PatchDraw> {
        let slots = self.slots(prepared, run);
        let record = |(patch, slot): (u32, u32)| {
            let levels = self.levels(prepared, run.pass, patch);
            // Nothing is drawn of a vacant slot.
            let drawn = levels.map(|levels| (levels.edges, levels.inside));
            let (edges, inside) = drawn.unwrap_or_default();
            abi::PatchDraw {
                slot,
                edges,
                inside,
            }
        };
        run.patches().zip(slots).map(record).collect()
    }

    /// The cut, as the backend makes it.
    pub fn cut(&self) -> Cut {
        self.cut
    }

    /// The plan level whose control points have to be cached for it; None where the ring has them.
    pub fn cached_level(&self) -> Option<u32> {
        self.cached_level
    }

    /// The options that it was made for.
    pub fn options(&self) -> &SurfaceOptions {
        &self.options
    }

    /// The batches, in the order in which they are drawn: each within the ring, and within the capture if there is one.
    pub fn batches(&self) -> impl ExactSizeIterator<Item = Batch<'_>> + Clone {
        self.of_round(0)
    }

    /// The batches once more in the same frame, for lines over a surface or a second view: round 0 is [`batches`](Self::batches).
    ///
    /// # Errors
    /// [`Misuse::Round`] beyond the [`rounds`](SurfaceOptions::rounds) of the options.
    pub fn round(&self, round: u32) -> Result<impl ExactSizeIterator<Item = Batch<'_>> + Clone> {
        let rounds = self.options.rounds;
        if round < rounds {
            Ok(self.of_round(round))
        } else {
            Err(Error::Misuse(Misuse::Round { round, rounds }))
        }
    }

    fn of_round(&self, round: u32) -> impl ExactSizeIterator<Item = Batch<'_>> + Clone {
        (0..self.runs.len()).map(move |number| Batch {
            list: self,
            number,
            round,
        })
    }

    /// Whether it holds what must be on the device before it is drawn.
    pub fn has_decisions(&self) -> bool {
        self.options.has_host_slots()
            || self.options.backend.has_patterns()
            || self.tagged.is_some()
            || self.sub_patches.is_some()
    }

    /// Whether patches have levels of their own.
    pub fn is_tagged(&self) -> bool {
        self.tagged.is_some()
    }

    /// The depths of irregularities, of methods that go as deep as a frame needs.
    #[cfg(feature = "vulkan")]
    pub(crate) fn depths(&self) -> Option<&[u32]> {
        self.depths.as_deref()
    }

    /// How many points a frame of it needs of those that are computed once a pose, and of how many terms they are sums: for methods that refine as deep as a frame
    /// needs, those of its depths.
    pub fn computed(&self, prepared: &Prepared) -> [u64; 2] {
        let points = &prepared.points;
        let steps = points.steps_at(self.depths.as_deref());
        let mut counts = [0; 2];
        for part in steps.iter().flatten() {
            counts[0] += u64::from(part.count);
            let rows = &points.rows[part.first_row as usize..][..part.count as usize];
            let terms = rows
                .iter()
                .map(|row| row.count & !(abi::ROW_OPEN | abi::ROW_FIRM));
            counts[1] += terms.map(u64::from).sum::<u64>();
        }
        counts
    }

    /// Whether patches may be cut into pieces before they are drawn.
    pub fn has_sub_patches(&self) -> bool {
        self.sub_patches.is_some()
    }

    /// What is drawn of a pass where patches may be cut into pieces first, each by itself: in the order of patches, row by row; empty where there are none, or
    /// no such pass.
    pub fn sub_patches(&self, pass: usize) -> &[abi::SubPatch] {
        let all = self.sub_patches.as_ref();
        all.and_then(|all| all.get(pass)).map_or(&[], Vec::as_slice)
    }

    /// What is decided about each patch of a pass; empty where the cut says all, sub-patches have it, or there is no such pass.
    pub fn records(&self, pass: usize) -> &[abi::PatchDraw] {
        self.records.get(pass).map_or(&[], Vec::as_slice)
    }

    /// The patches of a pass in the order of instances; empty where no patterns are drawn, or there is no such pass.
    pub fn instances(&self, pass: usize) -> &[u32] {
        self.instances.get(pass).map_or(&[], Vec::as_slice)
    }

    /// Levels that ask for each of the refinement patterns that are drawn.
    pub fn patterns(&self) -> &[Levels] {
        &self.patterns
    }

    /// A number that no other list has.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Whether it is of what was prepared, for these options, on a driver with this bound.
    pub fn is_for(
        &self,
        prepared: &Prepared,
        options: &SurfaceOptions,
        instance_vertices: Option<u32>,
    ) -> bool {
        self.is_of(prepared)
            && self.options == *options
            && self.instance_vertices == instance_vertices
    }

    /// Whether it is of what was prepared.
    pub(super) fn is_of(&self, prepared: &Prepared) -> bool {
        self.prepared == [prepared.number(), prepared.version()]
    }

    /// The levels of a patch; `prepared` is what the list was made for. None where there is no such patch, its slot is vacant, or it is not
    /// [chosen](Self::only).
    pub fn levels(&self, prepared: &Prepared, pass: usize, patch: u32) -> Option<Levels> {
        let patches = prepared.passes.get(pass)?;
        let tagged = match &self.tagged {
            Some(all) => Some(all.get(pass)?.as_slice()),
            None => None,
        };
        levels_of(patches, self.cut, tagged, patch as usize)
    }

    /// The different vertices of a patch; none where there is no such patch.
    pub fn vertices(&self, prepared: &Prepared, pass: usize, patch: u32) -> u32 {
        let Some(levels) = self.levels(prepared, pass, patch) else {
            return 0;
        };
        self.options.backend.vertices(&levels, self.cut.spacing)
    }

    /// The triangles of a patch: counter-clockwise in (u, v), as numbers of its vertices `uv`, which may come in any order. None where these are
    /// not all that the patch has: triangles over the hole would be another surface. None, too, where there is no such patch.
    pub fn triangles(
        &self,
        prepared: &Prepared,
        pass: usize,
        patch: u32,
        uv: &[[f32; 2]],
    ) -> Option<Vec<[u32; 3]>> {
        let levels = self.levels(prepared, pass, patch)?;
        match levels.piece_depth() {
            depth @ 1.. if self.has_sub_patches() => {
                let patch = &prepared.passes[pass].patches[patch as usize];
                join(patch, &levels, Piece::all(depth), uv)
            }
            _ => self.join(&levels, uv),
        }
    }

    /// The same of a patch at levels that a device has decided.
    pub fn join(&self, levels: &Levels, uv: &[[f32; 2]]) -> Option<Vec<[u32; 3]>> {
        self.options.backend.join(levels, self.cut.spacing, uv)
    }
}

/// A number that no list had before.
pub(super) fn new_number() -> u64 {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    NUMBER.fetch_add(1, Ordering::Relaxed)
}

/// Patches of a pass that are drawn at once.
#[derive(Clone, Copy, Debug)]
pub struct Batch<'a> {
    list: &'a DrawList,
    number: usize,
    round: u32,
}

impl<'a> Batch<'a> {
    /// The list that it belongs to.
    pub fn list(&self) -> &'a DrawList {
        self.list
    }

    fn run(&self) -> &'a Run {
        &self.list.runs[self.number]
    }

    /// The pass.
    pub fn pass(&self) -> usize {
        self.run().pass
    }

    /// The patches; of the first and the last there may be pieces in other batches. Where the device decides, all of the pass, of which each batch draws some.
    pub fn patches(&self) -> Range<u32> {
        match self.sub_patches() {
            [] => self.drawn(),
            [only] => only.patch_number..only.patch_number + 1,
            [first, .., last] => first.patch_number..last.patch_number + 1,
        }
    }

    /// The numbers of what is drawn: of patches, or where these may be cut into pieces, of [`DrawList::sub_patches`].
    pub fn drawn(&self) -> Range<u32> {
        self.run().patches()
    }

    /// Of [`DrawList::sub_patches`] those that it draws.
    pub(super) fn sub_patches(&self) -> &'a [abi::SubPatch] {
        let drawn = self.drawn();
        let all = self.list.sub_patches(self.pass());
        all.get(drawn.start as usize..drawn.end as usize)
            .unwrap_or_default()
    }

    /// Points that its patches need in the ring.
    pub fn points(&self) -> u32 {
        self.run().points
    }

    /// Vertices that are captured of its patches, each of them so often as pieces have it.
    pub fn vertices(&self) -> u32 {
        self.run().vertices
    }

    /// Which of all batches that use the ring this is, of all rounds.
    pub fn ring_batch(&self) -> u32 {
        self.run().ring_batch + self.round * self.list.ring_batches
    }

    /// Whether it must wait until an earlier batch is done with the ring.
    pub fn waits(&self) -> bool {
        self.points() > 0 && self.ring_batch() > 0
    }

    /// The draws that it consists of: one, except where patterns are drawn.
    pub fn draws(&self) -> &'a [Draw] {
        &self.list.draws[self.number]
    }
}

/// # Errors
/// [`Misuse::MacroFaces`] for fractional spacing: a side of a macro face has vertices where those of its faces are, with short steps within it.
fn check_macro_faces(prepared: &Prepared, cut: Cut) -> Result<()> {
    if prepared.macro_faces == MacroFaces::None || cut.spacing == Spacing::Equal {
        return Ok(());
    }
    let what = "fractional spacing";
    Err(Error::Misuse(Misuse::MacroFaces { what }))
}
