//! Plans faces into passes: all of them at first, and some of them again when the mesh is edited.
//!
//! A patch keeps its slot, which is its number in its pass, as long as its face is drawn with the same shaders. What leaves a slot leaves it vacant, for whoever
//! comes next. Plans and borders only ever grow ([`Planned`]); numbers of control vertices that nobody uses any more are taken again.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::Result;
use crate::mesh::topology::Topology;
use crate::mesh::{ChangeSet, Model};
use crate::method::outline::sides;
use crate::method::patches::Part;
use crate::method::quadtree::agreement::{agree, agreed_edges};
use crate::method::quadtree::border::Given;
use crate::method::quadtree::bounded;
use crate::method::quadtree::irregular::{Irregulars, NONE, Record, order, push_ring};
use crate::method::quadtree::log::{Log, PASSES, Place};
use crate::method::quadtree::places;
use crate::method::quadtree::planned::Planned;
use crate::method::quadtree::run::Run;
use crate::method::quadtree::surroundings::{Found, Surroundings, found as found_at};
use crate::method::{Pass, PassChange};
use crate::plan::{Database, PlanOptions, SmoothQuads};

/// The pass of regular patches.
const REGULAR: usize = 0;
/// That of patches with short rings: each invocation of the control shader can have a vertex of theirs.
const SHORT: usize = 1;
const LONG: usize = 2;
/// So many parts are on their way at a time.
const AT_A_TIME: usize = 1 << 11;
/// So many are few.
const FEW: usize = 1 << 6;

/// See the top of this file.
pub struct Planner {
    options: PlanOptions,
    planned: [Planned; 2],
    /// By face, see [`Irregulars::of_faces`].
    of_faces: Vec<u32>,
    /// By edge, see [`Given::agreed`].
    agreed: Vec<bool>,
    /// By ptex face.
    places: Vec<Option<Place>>,
    vacant: [Vec<u32>; PASSES],
    /// Where numbers of control vertices stand that nobody uses, by how many.
    free: [FxHashMap<u32, Vec<u32>>; PASSES],
    /// Whether passes have vacant slots to spare.
    spares: bool,
    /// Whether plans and borders are kept for edits.
    keeps: bool,
}

/// What is to be planned.
pub struct Wanted<'a, Parts: Iterator<Item = Part>> {
    /// The faces that may have changed; None of all, at first.
    pub faces: Option<&'a [u32]>,
    /// The parts of those that are drawn.
    pub parts: Parts,
    /// The ptex faces that are not drawn any more.
    pub gone: &'a [u32],
}

/// A patch that nothing is drawn of.
const VACANT: abi::Patch = abi::Patch {
    ptex: 0,
    flags: abi::PATCH_VACANT,
    controls: 0,
    plan: 0,
    valences: 0,
};

impl Planner {
    /// One that keeps what edits need, or that gives it all to the passes in the end.
    pub fn new(options: PlanOptions, keeps: bool) -> Planner {
        Planner {
            options,
            planned: Default::default(),
            of_faces: Vec::new(),
            agreed: Vec::new(),
            places: Vec::new(),
            vacant: Default::default(),
            free: Default::default(),
            spares: false,
            keeps,
        }
    }

    /// What the passes of patches with plans have beside their tables.
    pub fn planned(&self) -> &[Planned; 2] {
        &self.planned
    }

    /// Gives each pass vacant slots to spare, so that few edits make it longer.
    pub fn spare(&mut self, passes: &mut [Pass]) {
        self.spares = true;
        for (number, pass) in passes.iter_mut().enumerate() {
            let first = self.extend(number, pass);
            self.vacant[number].push(first);
        }
    }

    /// Gives edges the numbers that they have after an edit.
    pub fn renumber(&mut self, changes: &ChangeSet, topology: &Topology) {
        if !changes.is_reconnected() {
            return;
        }
        let mut agreed = vec![false; topology.edge_count()];
        for (edge, _) in (0..).zip(&self.agreed).filter(|(_, agreed)| **agreed) {
            if let Some(edge) = changes.edge(edge) {
                agreed[edge as usize] = true;
            }
        }
        self.agreed = agreed;
    }

    /// Plans faces, on the topology of what is smooth: the model's, perhaps with hubs. The passes are left as they were where that fails, and the planner is
    /// of no use then.
    ///
    /// # Errors
    /// As [`Store::plans`](super::store::Store::plans) and [`Borders::find`](super::border::Borders::find).
    pub fn plan(
        &mut self,
        passes: &mut [Pass],
        model: &Model,
        smooth: &SmoothQuads<'_>,
        wanted: Wanted<'_, impl Iterator<Item = Part>>,
        database: &Database,
    ) -> Result<Vec<PassChange>> {
        let mut log = Log::default();
        let ends: Vec<usize> = passes.iter().map(|pass| pass.controls.len()).collect();
        let slots: Vec<usize> = passes.iter().map(|pass| pass.patches.len()).collect();
        if let Err(error) = self.try_plan(passes, model, smooth, wanted, database, &mut log) {
            log.take_back(passes, &slots);
            return Err(error);
        }
        for (pass, start, count) in log.freed {
            self.free[pass].entry(count).or_default().push(start);
        }
        let mut changes = self.finish(passes);
        for (number, change) in changes.iter_mut().enumerate() {
            let own = log
                .before
                .iter()
                .filter(|before| before.place.pass() == number);
            change.patches(own.map(|before| before.place.slot()).collect());
            let appended = ends[number]..passes[number].controls.len();
            change.controls(&log.written[number], appended);
        }
        Ok(changes)
    }

    fn try_plan(
        &mut self,
        passes: &mut [Pass],
        model: &Model,
        smooth: &SmoothQuads<'_>,
        wanted: Wanted<'_, impl Iterator<Item = Part>>,
        database: &Database,
        log: &mut Log,
    ) -> Result<()> {
        let topology = smooth.topology();
        self.of_faces.resize(topology.face_count(), NONE);
        self.agreed.resize(topology.edge_count(), false);
        self.places.resize(model.mesh().ptex_count(), None);
        for &ptex in wanted.gone {
            self.leave(passes, ptex, log);
        }
        let mut runs: [Run; 2] = Default::default();
        let (mut parts, mut all) = (Vec::new(), Vec::new());
        let mut rest = wanted.parts;
        // Some parts are few enough whatever is around them.
        let mut crowded = None;
        loop {
            parts.extend(rest.by_ref().take(AT_A_TIME - parts.len()));
            if parts.is_empty() {
                break;
            }
            let crowded =
                parts.len() > FEW && *crowded.get_or_insert_with(|| bounded::is_crowded(topology));
            let count = match crowded {
                true => bounded::some(topology, &parts),
                false => parts.len(),
            };
            let found = parts[..count].par_iter();
            let found = found.map(|&part| found_at(model, topology, smooth, part));
            found.collect_into_vec(&mut all);
            for (&part, found) in parts.iter().zip(&mut all) {
                self.place(passes, topology, part, found, &mut runs, log);
            }
            parts.drain(..count);
        }
        drop(all);
        for (number, run) in runs.into_iter().enumerate() {
            self.plan_run(number, passes, smooth, wanted.faces, run, database, log)?;
        }
        Ok(())
    }

    /// Gives a part its place, and its patch all but the border.
    fn place(
        &mut self,
        passes: &mut [Pass],
        topology: &Topology,
        part: Part,
        found: &mut Found,
        runs: &mut [Run; 2],
        log: &mut Log,
    ) {
        let Found {
            patch,
            texture,
            surroundings,
        } = found;
        let number = match surroundings {
            Surroundings::Regular(_) => REGULAR,
            Surroundings::Irregular(ring)
                if ring.vertices.len() > abi::CONTROL_INVOCATIONS as usize =>
            {
                LONG
            }
            _ => SHORT,
        };
        let slot = self.slot(passes, number, part.ptex, log);
        let (place, pass) = (slot as usize, &mut passes[number]);
        let first = pass.controls.len();
        match surroundings {
            Surroundings::Regular(vertices) => pass.controls.extend_from_slice(vertices),
            Surroundings::Smooth(_, ring) => {
                push_ring(&mut pass.controls, ring.vertices(), ring.order());
            }
            Surroundings::Irregular(ring) => {
                let vertices = &ring.vertices;
                push_ring(&mut pass.controls, vertices, &order(vertices));
            }
        }
        patch.controls = self.keep(number, pass, first, log);
        if let Some(own) = pass.sides.get_mut(place) {
            *own = sides(topology, part, patch);
        }
        pass.patches[place] = *patch;
        pass.texture[place] = *texture;
        if number == REGULAR {
            return;
        }
        if number == SHORT && topology.face(part.face).len() == 4 {
            self.of_faces[part.face as usize] = slot;
        }
        let record = runs[number - SHORT].record(topology, part, surroundings);
        self.planned[number - SHORT].records[place] = record;
        runs[number - SHORT].slots.push(slot);
    }

    /// Plans the patches of a run: their insides, and their edges and corners.
    #[allow(clippy::too_many_arguments)] // What is planned, of what, and where it goes.
    fn plan_run(
        &mut self,
        number: usize,
        passes: &mut [Pass],
        smooth: &SmoothQuads<'_>,
        faces: Option<&[u32]>,
        run: Run,
        database: &Database,
        log: &mut Log,
    ) -> Result<()> {
        let (pass_number, topology) = (SHORT + number, smooth.topology());
        let Run {
            mut slots,
            configurations,
            ..
        } = run;
        let Planned {
            store,
            borders,
            records,
            inside_bytes,
        } = &mut self.planned[number];
        let numbers = store.plans(configurations, self.options, database)?;
        *inside_bytes = store.packed.quadtree_bytes();
        for &slot in &slots {
            let record = &mut records[slot as usize];
            record.plan = numbers[record.plan as usize];
        }
        let pass = &mut passes[pass_number];
        let patches = Irregulars {
            records,
            of_faces: &self.of_faces,
            pass,
        };
        if pass_number == SHORT {
            let agreed = agreed_edges(topology, smooth, &patches, &slots, store);
            agree(
                topology,
                faces,
                &agreed,
                &mut self.agreed,
                &patches,
                &mut slots,
            );
        }
        let given = Given {
            topology,
            smooth,
            patches: &patches,
            agreed: &self.agreed,
        };
        let found = borders.find(given, &slots, store, self.options, database)?;
        pass.controls.extend_from_slice(&found.places);
        for (slot, border) in slots.into_iter().zip(found.numbers) {
            let place = Place::new(pass_number, slot);
            if self.spares && pass.patches[slot as usize].plan != border {
                log.remember(pass, place);
            }
            pass.patches[slot as usize].plan = border;
        }
        Ok(())
    }

    /// The slot of a ptex face in a pass: its own, or one that is vacant.
    fn slot(&mut self, passes: &mut [Pass], number: usize, ptex: u32, log: &mut Log) -> u32 {
        match self.places[ptex as usize] {
            Some(place) if place.pass() == number => {
                self.let_go(passes, place, log);
                return place.slot();
            }
            Some(_) => self.leave(passes, ptex, log),
            None => {}
        }
        let slot = self.vacant[number].pop();
        let slot = slot.unwrap_or_else(|| self.extend(number, &mut passes[number]));
        let place = Place::new(number, slot);
        self.places[ptex as usize] = Some(place);
        if self.spares {
            log.remember(&passes[number], place);
        }
        slot
    }

    /// Makes the slot of a ptex face vacant.
    fn leave(&mut self, passes: &mut [Pass], ptex: u32, log: &mut Log) {
        let Some(place) = self.places[ptex as usize].take() else {
            return;
        };
        self.let_go(passes, place, log);
        let (pass, slot) = (&mut passes[place.pass()], place.slot() as usize);
        pass.patches[slot] = VACANT;
        // Sides keep up with edges only as long as somebody has them.
        if let Some(sides) = pass.sides.get_mut(slot) {
            *sides = [0; 4];
        }
        self.vacant[place.pass()].push(place.slot());
    }

    /// Takes down what a patch was, whose control vertices are somewhere else afterwards.
    fn let_go(&mut self, passes: &[Pass], place: Place, log: &mut Log) {
        let slot = place.slot() as usize;
        let patch = passes[place.pass()].patches[slot];
        let count = match place.pass() {
            REGULAR => 16,
            pass => {
                let record = &self.planned[pass - SHORT].records[slot];
                let face = record.part.face as usize;
                if self.of_faces[face] == place.slot() && pass == SHORT {
                    self.of_faces[face] = NONE;
                }
                let size = record.ring_size as usize;
                (size + places::words(size, size)) as u32
            }
        };
        log.freed.push((place.pass(), patch.controls, count));
        log.remember(&passes[place.pass()], place);
    }

    /// Where numbers of control vertices are kept that were just appended: where there were as many that nobody uses, or there at the end.
    fn keep(&mut self, number: usize, pass: &mut Pass, first: usize, log: &mut Log) -> u32 {
        let count = (pass.controls.len() - first) as u32;
        let free = self.free[number].get_mut(&count).and_then(Vec::pop);
        let Some(start) = free else {
            return first as u32;
        };
        pass.controls.copy_within(first.., start as usize);
        pass.controls.truncate(first);
        log.written[number].push(start..start + count);
        start
    }

    /// Makes a pass longer by a slot, or, once there are slots to spare, by an eighth and some; returns the first, and leaves the others vacant.
    fn extend(&mut self, number: usize, pass: &mut Pass) -> u32 {
        let first = pass.patches.len();
        let records = number.checked_sub(SHORT);
        let records = records.map(|number| &mut self.planned[number].records);
        if !self.spares {
            pass.patches.push(VACANT);
            pass.texture.push(Default::default());
            records.into_iter().for_each(|all| all.push(Record::VACANT));
            return first as u32;
        }
        let end = first + first / 8 + 64;
        pass.patches.resize(end, VACANT);
        pass.texture.resize(end, Default::default());
        pass.sides.resize(end, [0; 4]);
        let records = records.into_iter();
        records.for_each(|all| all.resize(end, Record::VACANT));
        // The first of the rest is taken first.
        self.vacant[number].extend((first as u32 + 1..end as u32).rev());
        first as u32
    }

    /// Brings the passes up to their plans and borders; tables only where there will be edits.
    fn finish(&mut self, passes: &mut [Pass]) -> Vec<PassChange> {
        let mut changes = vec![PassChange::default(); passes.len()];
        for (number, planned) in self.planned.iter_mut().enumerate() {
            let number = SHORT + number;
            planned.count(&mut passes[number]);
            if self.keeps {
                planned.grow(&mut passes[number], &mut changes[number]);
            }
        }
        changes
    }

    /// Gives the passes their tables, where nothing will be edited.
    pub fn give(self, passes: &mut [Pass]) {
        for (pass, planned) in passes[SHORT..].iter_mut().zip(self.planned) {
            pass.tables = planned.into_tables();
        }
    }
}
