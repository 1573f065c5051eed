//! Plans faces into passes: all of them at first, and some of them again when the mesh is edited.
//!
//! A patch keeps its slot, which is its number in its pass, as long as its face is drawn with the same shaders. What leaves a slot leaves it vacant, for whoever
//! comes next. Plans and borders only ever grow ([`Store`], [`Borders`]); numbers of control vertices that nobody uses any more are taken again.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::Result;
use crate::mesh::Model;
use crate::mesh::topology::Topology;
use crate::method::outline::sides;
use crate::method::patches::Part;
use crate::method::quadtree::agreement::agreed_edges;
use crate::method::quadtree::border::{Borders, Given};
use crate::method::quadtree::irregular::{Irregulars, NONE, Record, order, push_ring};
use crate::method::quadtree::places;
use crate::method::quadtree::store::Store;
use crate::method::quadtree::surroundings::{Found, Surroundings, found};
use crate::method::quadtree::view::sums;
use crate::method::{Pass, PassChange, Table};
use crate::plan::database::{Entry, Kind};
use crate::plan::{Configuration, Database, PlanOptions, Ring, SmoothQuads};

/// The passes, in their order: regular patches, patches with plans and short rings, patches with plans and long rings.
pub const PASSES: usize = 3;
/// The pass of regular patches.
const REGULAR: usize = 0;
/// That of patches with short rings: each invocation of the control shader can have a vertex of theirs.
const SHORT: usize = 1;
const LONG: usize = 2;
/// So many parts are on their way at a time.
const AT_A_TIME: usize = 1 << 13;

/// Where the patch of a ptex face is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    pass: usize,
    slot: u32,
}

/// What a pass of patches with plans has beside its tables.
#[derive(Clone, Default)]
pub struct Planned {
    /// Its plans.
    pub store: Store,
    /// Its borders.
    pub borders: Borders,
    /// By slot.
    pub records: Vec<Record>,
    /// The words of quadtrees that are plans of insides; only when all faces were planned at once.
    pub inside_bytes: usize,
}

/// See the top of this file.
#[derive(Clone)]
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
}

/// What is to be planned.
pub struct Wanted<'a> {
    /// The faces that may have changed; all of them at first.
    pub faces: &'a [u32],
    /// The parts of those that are drawn.
    pub parts: &'a [Part],
    /// The ptex faces that are not drawn any more.
    pub gone: &'a [u32],
}

/// Patches on their way to a pass, and the different configurations that they have.
#[derive(Default)]
struct Run {
    slots: Vec<u32>,
    numbers: FxHashMap<Configuration, u32>,
    /// Those of smooth rings, by their keys.
    smooth: FxHashMap<u32, u32>,
}

/// What can be taken back, and what is let go at the end.
#[derive(Default)]
struct Log {
    /// Patches and their texture coordinates before, in the order in which they were changed.
    before: Vec<(Place, abi::Patch, [[f32; 2]; 4])>,
    /// Numbers of control vertices: pass, start, count.
    freed: Vec<(usize, u32, u32)>,
    /// By pass, where numbers of control vertices were written below the end of the list.
    written: [Vec<std::ops::Range<u32>>; PASSES],
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
    pub fn new(options: PlanOptions) -> Planner {
        Planner {
            options,
            planned: Default::default(),
            of_faces: Vec::new(),
            agreed: Vec::new(),
            places: Vec::new(),
            vacant: Default::default(),
            free: Default::default(),
            spares: false,
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
            self.extend(number, pass);
        }
    }

    /// Plans faces. The passes are left as they were where that fails, and the planner is of no use then.
    ///
    /// # Errors
    /// As [`Store::plans`] and [`Borders::find`].
    pub fn plan(
        &mut self,
        passes: &mut [Pass],
        model: &Model,
        wanted: &Wanted<'_>,
        database: &Database,
    ) -> Result<Vec<PassChange>> {
        let mut log = Log::default();
        let ends: Vec<usize> = passes.iter().map(|pass| pass.controls.len()).collect();
        match self.try_plan(passes, model, wanted, database, &mut log) {
            Ok(()) => {
                for (pass, start, count) in log.freed {
                    self.free[pass].entry(count).or_default().push(start);
                }
                let mut changes = self.finish(passes);
                for (number, change) in changes.iter_mut().enumerate() {
                    let slots = log.before.iter().filter(|(at, ..)| at.pass == number);
                    change.patches(slots.map(|(at, ..)| at.slot).collect());
                    change.controls(
                        &log.written[number],
                        ends[number]..passes[number].controls.len(),
                    );
                }
                Ok(changes)
            }
            Err(error) => {
                for (Place { pass, slot }, patch, texture) in log.before.into_iter().rev() {
                    passes[pass].patches[slot as usize] = patch;
                    passes[pass].texture[slot as usize] = texture;
                }
                Err(error)
            }
        }
    }

    fn try_plan(
        &mut self,
        passes: &mut [Pass],
        model: &Model,
        wanted: &Wanted<'_>,
        database: &Database,
        log: &mut Log,
    ) -> Result<()> {
        let topology = model.topology();
        let smooth = SmoothQuads::new(topology);
        self.of_faces.resize(topology.face_count(), NONE);
        self.agreed.resize(topology.edge_count(), false);
        self.places.resize(model.mesh().ptex_count(), None);
        for &ptex in wanted.gone {
            self.leave(passes, ptex, log);
        }
        let mut runs: [Run; 2] = Default::default();
        let mut all = Vec::with_capacity(AT_A_TIME.min(wanted.parts.len()));
        for parts in wanted.parts.chunks(AT_A_TIME) {
            let found = parts.par_iter().map(|&part| found(model, &smooth, part));
            found.collect_into_vec(&mut all);
            for (&part, found) in parts.iter().zip(all.drain(..)) {
                self.place(passes, topology, part, found, &mut runs, log);
            }
        }
        drop(all);
        for (number, run) in runs.into_iter().enumerate() {
            self.plan_run(
                number,
                passes,
                model,
                &smooth,
                wanted.faces,
                run,
                database,
                log,
            )?;
        }
        Ok(())
    }

    /// Gives a part its place, and its patch all but the border.
    fn place(
        &mut self,
        passes: &mut [Pass],
        topology: &Topology,
        part: Part,
        found: Found,
        runs: &mut [Run; 2],
        log: &mut Log,
    ) {
        let Found {
            mut patch,
            texture,
            surroundings,
        } = found;
        let number = match &surroundings {
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
        let mut controls = Vec::new();
        match &surroundings {
            Surroundings::Regular(vertices) => controls.extend_from_slice(vertices),
            Surroundings::Smooth(_, ring) => {
                let order = ring.order().iter().copied().map(u16::from);
                push_ring(&mut controls, ring.vertices(), order);
            }
            Surroundings::Irregular(ring) => {
                let vertices = &ring.vertices;
                push_ring(&mut controls, vertices, order(vertices).into_iter());
            }
        }
        patch.controls = self.keep(number, pass, &controls, log);
        if let Some(own) = pass.sides.get_mut(place) {
            *own = sides(topology, part, &patch);
        }
        pass.patches[place] = patch;
        pass.texture[place] = texture;
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
        model: &Model,
        smooth: &SmoothQuads<'_>,
        faces: &[u32],
        run: Run,
        database: &Database,
        log: &mut Log,
    ) -> Result<()> {
        let topology = model.topology();
        let Run {
            mut slots, numbers, ..
        } = run;
        let mut configurations: Vec<(Configuration, u32)> = numbers.into_iter().collect();
        configurations.sort_unstable_by_key(|&(_, number)| number);
        let Planned {
            store,
            borders,
            records,
            inside_bytes,
        } = &mut self.planned[number];
        let kinds = configurations.iter().map(|(all, _)| (Kind::Inside, all));
        let numbers = store.plans(kinds, self.options, database)?;
        drop(configurations);
        *inside_bytes = store.packed.quadtree_bytes();
        for &slot in &slots {
            let record = &mut records[slot as usize];
            record.plan = numbers[record.plan as usize];
        }
        let pass = &mut passes[SHORT + number];
        let patches = Irregulars {
            records,
            of_faces: &self.of_faces,
            pass,
        };
        if SHORT + number == SHORT {
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
            let place = Place {
                pass: SHORT + number,
                slot,
            };
            let patch = &mut pass.patches[slot as usize];
            if patch.plan != border {
                log.before
                    .push((place, *patch, pass.texture[slot as usize]));
                patch.plan = border;
            }
        }
        Ok(())
    }

    /// The slot of a ptex face in a pass: its own, or one that is vacant.
    fn slot(&mut self, passes: &mut [Pass], number: usize, ptex: u32, log: &mut Log) -> u32 {
        match self.places[ptex as usize] {
            Some(place) if place.pass == number => {
                self.let_go(passes, place, log);
                return place.slot;
            }
            Some(_) => self.leave(passes, ptex, log),
            None => {}
        }
        if self.vacant[number].is_empty() {
            self.extend(number, &mut passes[number]);
        }
        let slot = self.vacant[number].pop();
        let slot = slot.expect("a pass was just made longer");
        let place = Place { pass: number, slot };
        self.places[ptex as usize] = Some(place);
        if self.spares {
            let texture = passes[number].texture[slot as usize];
            log.before.push((place, VACANT, texture));
        }
        slot
    }

    /// Makes the slot of a ptex face vacant.
    fn leave(&mut self, passes: &mut [Pass], ptex: u32, log: &mut Log) {
        let Some(place) = self.places[ptex as usize].take() else {
            return;
        };
        self.let_go(passes, place, log);
        passes[place.pass].patches[place.slot as usize] = VACANT;
        self.vacant[place.pass].push(place.slot);
    }

    /// Takes down what a patch was, whose control vertices are somewhere else afterwards.
    fn let_go(&mut self, passes: &[Pass], place: Place, log: &mut Log) {
        let slot = place.slot as usize;
        let patch = passes[place.pass].patches[slot];
        let count = match place.pass {
            REGULAR => 16,
            pass => {
                let record = &self.planned[pass - SHORT].records[slot];
                let face = record.part.face as usize;
                if self.of_faces[face] == place.slot && pass == SHORT {
                    self.of_faces[face] = NONE;
                }
                let size = record.ring_size as usize;
                (size + places::words(size, size)) as u32
            }
        };
        log.freed.push((place.pass, patch.controls, count));
        let texture = passes[place.pass].texture[slot];
        log.before.push((place, patch, texture));
    }

    /// Where numbers of control vertices are kept: where there were as many that nobody uses, or at the end.
    fn keep(&mut self, number: usize, pass: &mut Pass, controls: &[u32], log: &mut Log) -> u32 {
        let count = controls.len() as u32;
        let free = self.free[number].get_mut(&count).and_then(Vec::pop);
        let Some(start) = free else {
            pass.controls.extend_from_slice(controls);
            return pass.controls.len() as u32 - count;
        };
        pass.controls[start as usize..][..controls.len()].copy_from_slice(controls);
        log.written[number].push(start..start + count);
        start
    }

    /// Makes a pass longer by a slot, or, once there are slots to spare, by an eighth and some.
    fn extend(&mut self, number: usize, pass: &mut Pass) {
        let first = pass.patches.len();
        let count = if self.spares { first / 8 + 64 } else { 1 };
        let end = first + count;
        pass.patches.resize(end, VACANT);
        pass.texture.resize(end, Default::default());
        if self.spares {
            pass.sides.resize(end, [0; 4]);
        }
        if number > REGULAR {
            let records = &mut self.planned[number - SHORT].records;
            records.resize(end, Record::VACANT);
        }
        // The first is taken first.
        self.vacant[number].extend((first as u32..end as u32).rev());
    }

    /// Brings the passes' tables up to their plans and borders.
    fn finish(&mut self, passes: &mut [Pass]) -> Vec<PassChange> {
        let mut changes = vec![PassChange::default(); passes.len()];
        for (number, planned) in self.planned.iter_mut().enumerate() {
            let change = &mut changes[SHORT + number];
            planned.finish(&mut passes[SHORT + number], change);
        }
        changes
    }
}

/// Takes down which edges of some faces are agreed upon, and adds the patches beyond those of which that has changed.
fn agree(
    topology: &Topology,
    faces: &[u32],
    now: &[u32],
    agreed: &mut [bool],
    patches: &Irregulars<'_>,
    slots: &mut Vec<u32>,
) {
    let edges = || faces.iter().flat_map(|&face| topology.face_edges(face));
    let before: Vec<bool> = edges().map(|&edge| agreed[edge as usize]).collect();
    edges().for_each(|&edge| agreed[edge as usize] = false);
    now.iter().for_each(|&edge| agreed[edge as usize] = true);
    let changed = edges()
        .zip(before)
        .filter(|&(&edge, before)| agreed[edge as usize] != before);
    let beyond = changed.flat_map(|(&edge, _)| topology.edge_faces(edge));
    let mut others: Vec<u32> = beyond.filter_map(|&face| patches.of_face(face)).collect();
    if others.is_empty() {
        return;
    }
    others.sort_unstable();
    others.dedup();
    let known: rustc_hash::FxHashSet<u32> = slots.iter().copied().collect();
    slots.extend(others.into_iter().filter(|slot| !known.contains(slot)));
}

impl Run {
    /// What a patch is; its plan is the number of its configuration in the run.
    fn record(&mut self, topology: &Topology, part: Part, surroundings: Surroundings) -> Record {
        let next = self.numbers.len() as u32;
        let mut number = |configuration| *self.numbers.entry(configuration).or_insert(next);
        match surroundings {
            Surroundings::Regular(_) => unreachable!("it needs no plan"),
            Surroundings::Smooth(start, ring) => {
                let plan = self.smooth.entry(start.key).or_insert_with(|| {
                    let ring = Ring::of_quad(topology, part.face);
                    number(ring.expect("a smooth face is a quad").configuration)
                });
                Record {
                    part,
                    plan: *plan,
                    ring_size: ring.vertices().len() as u32,
                    start: start.corner as u8,
                    mirrored: start.mirrored,
                    is_smooth: true,
                }
            }
            Surroundings::Irregular(ring) => Record {
                part,
                plan: number(ring.configuration),
                ring_size: ring.vertices.len() as u32,
                start: ring.start as u8,
                mirrored: ring.mirrored,
                is_smooth: false,
            },
        }
    }
}

impl Planned {
    /// How many plans there are of insides, edges, and vertices.
    pub fn counts(&self) -> [usize; 3] {
        let mut counts = [0; 3];
        for entry in self.store.entries() {
            counts[match entry {
                Entry::Inside(_) => 0,
                Entry::Edge(_) => 1,
                Entry::Vertex(_) => 2,
            }] += 1;
        }
        counts
    }

    /// Brings a pass' tables up to its plans and borders.
    fn finish(&mut self, pass: &mut Pass, change: &mut PassChange) {
        let Borders {
            records,
            uses,
            ends,
            ..
        } = &self.borders;
        let known = pass.scratch_points.len();
        for border in &records[known..] {
            let (points, products) = sums(border, uses, ends);
            pass.scratch_points.push(points);
            pass.scratch_products.push(products);
        }
        let packed = &mut self.store.packed;
        let products = packed.headers.iter().map(|header| {
            let stencils = header.counts.iter().copied().max().unwrap_or(0);
            u64::from(header.ring_size) * u64::from(stencils)
        });
        packed.rows.hold(products.max().unwrap_or(0));
        let rows = packed.rows.view();
        let tables = [
            Table::grown(&packed.nodes),
            Table::grown(bytemuck::cast_slice::<u32, [u32; 2]>(&packed.points)),
            Table::grown(rows.rows),
            Table::grown(rows.sets),
            Table::grown(rows.patterns),
            Table::grown(uses),
            Table::grown(ends),
            Table::grown(records),
        ];
        for (number, (words, stride)) in tables.into_iter().enumerate() {
            if pass.tables.len() == number {
                pass.tables.push(Table::default());
            }
            change.own(number, pass.tables[number].grow(words, stride));
        }
    }
}
