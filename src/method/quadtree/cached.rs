//! The control points of irregular patches, each once.
//!
//! Patches share what is a sum of the same weights over the same vertices in the same order, relative to the same vertex, and therefore has the same
//! bits; the limits and normals of corners; and copies of vertices.

use std::hash::{Hash, Hasher};

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet, FxHasher};
use smallvec::SmallVec;

use crate::abi;
use crate::method::cached::{CachedPass, CachedPoints};
use crate::method::quadtree::macro_faces;
use crate::method::quadtree::twin::{Use, plans};
use crate::method::quadtree::view::Border;
use crate::method::{Pass, Prepared, Table};
use crate::tessellation::{Spacing, levels, required_level};

const USES: usize = abi::USES as usize;

/// The vertices of a ring.
type Vertices = SmallVec<[u32; 32]>;

/// A point that a patch needs.
#[derive(Clone, Copy)]
pub(super) struct Needed {
    /// Of what makes points the same.
    pub hash: u64,
    /// `JOB_...`, the use, and a row of its plan or a place in the ring.
    pub job: u32,
    /// The level of a cut from which on it is needed.
    pub level: u32,
}

/// What a patch needs, and where it looks for it.
#[derive(Default)]
pub(super) struct PatchPoints {
    pub needed: Vec<Needed>,
    /// Where the points of each use begin among `places`.
    starts: [u32; USES],
    /// Numbers of `needed`, and whether the point behind it is meant: the origins of the uses, the plain vertices, the points of each use.
    places: Vec<(u32, bool)>,
}

impl PatchPoints {
    /// What shaders read of it, at a place in the pass's table, when the points have these places in the cache.
    pub fn words(&self, first: u32, place: impl Fn(u32) -> u32) -> Vec<u32> {
        let starts = self.starts.map(|start| first + abi::USES + start);
        let places = self.places.iter();
        let places = places.map(|&(needed, second)| place(needed) + u32::from(second));
        starts.into_iter().chain(places).collect()
    }
}

/// A point of the cache, and the patch that computes it.
pub(super) struct Owned {
    pub pass: usize,
    pub patch: usize,
    pub job: u32,
    pub level: u32,
}

/// A patch as its points are told from others'.
#[derive(Clone, Copy)]
pub(super) struct Patch<'a> {
    pass: &'a Pass,
    border: Border<'a>,
    number: usize,
}

/// The patches whose points are cached: pass and number.
pub(super) fn patches(prepared: &Prepared) -> Vec<(usize, &Pass, usize)> {
    let passes = prepared.passes.iter().enumerate();
    let cached = passes.filter(|(_, pass)| pass.cached.is_some());
    cached
        .flat_map(|(i, pass)| (0..pass.patches.len()).map(move |number| (i, pass, number)))
        .collect()
}

/// What patches need up to a plan level.
pub(super) fn needed(all: &[(usize, &Pass, usize)], deepest: u32) -> Vec<PatchPoints> {
    let rows = all.iter().flat_map(|&(number, pass, patch)| {
        macro_faces::single_row(pass, patch).map(move |cell| (number, cell))
    });
    let rows: FxHashSet<(usize, usize)> = rows.collect();
    let of = |&(number, pass, patch): &(usize, &Pass, usize)| {
        let least = u32::from(rows.contains(&(number, patch)));
        match macro_faces::has_points(pass, patch) {
            true => Patch::new(pass, patch).points(least, deepest),
            false => PatchPoints::default(),
        }
    };
    all.par_iter().map(of).collect()
}

/// What a cache holds up to a plan level.
pub fn cached_points(prepared: &Prepared, deepest: u32) -> CachedPoints {
    let all = patches(prepared);
    let points = needed(&all, deepest);
    let (owned, numbers) = shared(prepared, &all, &points);
    let mut made = CachedPoints {
        passes: vec![CachedPass::default(); prepared.passes.len()],
        ..CachedPoints::default()
    };
    let (jobs, places) = place(prepared, &owned, &mut made);
    let mut blocks: Vec<[Vec<u32>; 2]> = vec![Default::default(); prepared.passes.len()];
    for ((&(pass, ..), points), numbers) in all.iter().zip(&points).zip(&numbers) {
        let [starts, block] = &mut blocks[pass];
        let first = block.len() as u32;
        starts.push(first);
        let place = |needed: u32| places[numbers[needed as usize] as usize];
        block.extend(points.words(first, place));
    }
    for ((pass, [starts, block]), jobs) in made.passes.iter_mut().zip(&blocks).zip(&jobs) {
        pass.tables = vec![Table::of(starts), Table::of(block), Table::of(jobs)];
    }
    made
}

/// Gives points their places, level by level, and each pass its jobs in this order.
fn place(
    prepared: &Prepared,
    owned: &[Owned],
    made: &mut CachedPoints,
) -> (Vec<Vec<[u32; 2]>>, Vec<u32>) {
    let mut order: Vec<u32> = (0..owned.len() as u32).collect();
    order.sort_by_key(|&number| {
        let owned = &owned[number as usize];
        (owned.level, owned.pass)
    });
    let mut jobs: Vec<Vec<[u32; 2]>> = vec![Vec::new(); prepared.passes.len()];
    let mut places = vec![0; owned.len()];
    // Behind the points that are computed beforehand, two vectors each.
    let mut next = 2 * prepared.points.count;
    made.ends.fill(next);
    for number in order {
        let Owned {
            pass,
            patch,
            job,
            level,
        } = owned[number as usize];
        places[number as usize] = next;
        let own = &mut made.passes[pass].jobs[level as usize];
        if own.count == 0 {
            (own.first, own.first_point) = (jobs[pass].len() as u32, next);
        }
        let owner = Patch::new(&prepared.passes[pass], patch);
        for job in with_normal(job) {
            jobs[pass].push([patch as u32, job]);
            made.sums[level as usize] += owner.products(job);
            own.count += 1;
            next += 1;
        }
        made.ends[level as usize] = next;
    }
    for level in 1..made.ends.len() {
        made.ends[level] = made.ends[level].max(made.ends[level - 1]);
        made.sums[level] += made.sums[level - 1];
    }
    (jobs, places)
}

/// Each point once, and for each patch which these are that it needs. Points of the same hash are taken for the same; where that proves wrong, a patch has
/// its own.
pub(super) fn shared(
    prepared: &Prepared,
    all: &[(usize, &Pass, usize)],
    points: &[PatchPoints],
) -> (Vec<Owned>, Vec<Vec<u32>>) {
    let mut owned: Vec<Owned> = Vec::new();
    let mut known: FxHashMap<u64, u32> = FxHashMap::default();
    let own = |&(pass, _, patch): &(usize, &Pass, usize), needed: &Needed| Owned {
        pass,
        patch,
        job: needed.job,
        level: needed.level,
    };
    let mut numbers: Vec<Vec<u32>> = Vec::with_capacity(all.len());
    for (patch, points) in all.iter().zip(points) {
        let number_of = |needed: &Needed| {
            let number = *known.entry(needed.hash).or_insert_with(|| {
                owned.push(own(patch, needed));
                owned.len() as u32 - 1
            });
            let level = &mut owned[number as usize].level;
            *level = needed.level.min(*level);
            number
        };
        numbers.push(points.needed.iter().map(number_of).collect());
    }
    let is_wrong = |of: &usize, place: &usize| {
        let (_, pass, number) = all[*of];
        let owner = &owned[numbers[*of][*place] as usize];
        let other = Patch::new(&prepared.passes[owner.pass], owner.patch);
        let job = points[*of].needed[*place].job;
        !Patch::new(pass, number).is_same(job, other, owner.job)
    };
    let wrong: Vec<(usize, usize)> = (0..all.len())
        .into_par_iter()
        .flat_map_iter(|of| {
            let places = 0..numbers[of].len();
            places
                .filter(move |place| is_wrong(&of, place))
                .map(move |place| (of, place))
        })
        .collect();
    for (of, place) in wrong {
        numbers[of][place] = owned.len() as u32;
        owned.push(own(&all[of], &points[of].needed[place]));
    }
    (owned, numbers)
}

fn job(kind: u32, number: usize, row: u32) -> u32 {
    kind << abi::JOB_KIND_SHIFT | (number as u32) << abi::JOB_USE_SHIFT | row
}

/// The kind of a job, its use and its row.
fn parts(job: u32) -> (u32, usize, u32) {
    let number = job >> abi::JOB_USE_SHIFT & 15;
    (job >> abi::JOB_KIND_SHIFT, number as usize, job & 0xffff)
}

/// A corner's limit comes with its normal.
pub(super) fn with_normal(own: u32) -> impl Iterator<Item = u32> {
    let (kind, number, row) = parts(own);
    let normal = (kind == abi::JOB_LIMIT).then(|| job(abi::JOB_NORMAL, number, row));
    std::iter::once(own).chain(normal)
}

impl<'a> Patch<'a> {
    pub fn new(pass: &'a Pass, number: usize) -> Patch<'a> {
        Patch {
            pass,
            border: Border::of(pass, number),
            number,
        }
    }

    fn of(self, number: usize) -> Use<'a> {
        Use {
            pass: self.pass,
            plans: plans(self.pass),
            border: self.border,
            controls: self.pass.patches[self.number].controls,
            number,
        }
    }

    /// The vertex at a place of the patch's ring.
    fn vertex(self, place: u32) -> u32 {
        let controls = self.pass.patches[self.number].controls;
        self.pass.controls[(controls + place) as usize]
    }

    pub fn products(self, job: u32) -> u64 {
        let (kind, number, _) = parts(job);
        let size = u64::from(self.border.used(number).size);
        match kind {
            abi::JOB_VERTEX => 0,
            abi::JOB_NORMAL => 2 * size,
            _ => size,
        }
    }

    /// The plan level that a cut of one has here.
    fn level(self, level: u32) -> u32 {
        let Pass {
            domain,
            patches,
            max_level,
            ..
        } = self.pass;
        let tess_level = (1u32 << level) as f32;
        let levels = levels(
            *domain,
            &patches[self.number],
            tess_level,
            Spacing::Equal,
            *max_level,
        );
        required_level(&levels, abi::HIGHEST_LEVEL)
    }

    /// How many points of use `number` a plan level has.
    fn count(self, level: u32, number: usize) -> u32 {
        let start = match number {
            0 => abi::USES + self.border.record.plain_count,
            _ => self.border.end(level, number - 1),
        };
        self.border.end(level, number) - start
    }

    /// Those of plan levels up to one, of which none is less than `least`.
    fn points(self, least: u32, deepest: u32) -> PatchPoints {
        let levels = (0..=deepest).map(|level| self.level(level).max(least));
        let levels: Vec<u32> = levels.collect();
        let mut points = PatchPoints {
            needed: Vec::new(),
            starts: [0; USES],
            places: Vec::new(),
        };
        let mut copies: FxHashMap<u32, u32> = FxHashMap::default();
        let own = self.of(0);
        let origins = (0..USES).map(|number| match number {
            0 => 0,
            _ if number >= 5 || self.border.used(number).size > 0 => {
                own.place(self.border.used(number).ring, 0)
            }
            _ => 0,
        });
        let abi::Border {
            plain, plain_count, ..
        } = *self.border.record;
        let plain = (0..plain_count as usize).map(|i| own.place(plain, i));
        for place in origins.chain(plain) {
            let number = *copies.entry(place).or_insert_with(|| {
                points.push(self, job(abi::JOB_VERTEX, 0, place), 0);
                points.needed.len() as u32 - 1
            });
            points.places.push((number, false));
        }
        for number in 0..USES {
            points.starts[number] = points.places.len() as u32;
            let plan = self.border.used(number).size > 0;
            let is_corner = number >= 5 && plan;
            if is_corner {
                points.push(self, job(abi::JOB_LIMIT, number, 0), 0);
                let own = points.needed.len() as u32 - 1;
                points.places.extend([(own, false), (own, true)]);
                continue;
            }
            let counts = levels.iter().map(|&level| self.count(level, number));
            let counts: Vec<u32> = counts.collect();
            let vertices: Vertices = self.of(number).vertices().collect();
            for row in 0..counts.last().copied().unwrap_or(0) {
                let level = counts.partition_point(|&count| count <= row) as u32;
                let job = job(abi::JOB_STENCIL, number, row);
                let mut hasher = FxHasher::default();
                self.terms(number, row, &vertices, |term| term.hash(&mut hasher));
                let hash = hasher.finish();
                points.needed.push(Needed { hash, job, level });
                points.places.push((points.needed.len() as u32 - 1, false));
            }
        }
        for number in 1..USES {
            let used = self.border.used(number);
            if used.flags & abi::USE_INSIDE != 0 {
                points.starts[number] = points.starts[0];
            } else if used.size == 0 {
                points.starts[number] = abi::USES;
            }
        }
        points
    }

    /// Of a vertex, or of a corner.
    fn hash(self, job: u32) -> u64 {
        let mut hasher = FxHasher::default();
        let (kind, number, row) = parts(job);
        kind.hash(&mut hasher);
        if kind == abi::JOB_VERTEX {
            self.vertex(row).hash(&mut hasher);
        } else {
            self.corner_key(number).hash(&mut hasher);
            let of = self.of(number);
            of.vertices().for_each(|vertex| vertex.hash(&mut hasher));
        }
        hasher.finish()
    }

    /// What two corners have alike that get the same limit and normal from the same ring. Where those nearby have a say, which are a face's own, none are.
    fn corner_key(self, number: usize) -> [u32; 4] {
        let &abi::Use {
            rows, flags, root, ..
        } = self.border.used(number);
        let own = match root {
            _ if flags & abi::USE_HUB != 0 => abi::NO_TANGENTS,
            abi::NO_TANGENTS => root,
            _ => self.number as u32,
        };
        [rows, flags, root, own]
    }

    /// What a point is a sum of, after the vertex that it is relative to, in the order in which it is added. Long sums are compensated: what is
    /// added to them counts even if it is zero.
    fn terms(self, number: usize, row: u32, vertices: &[u32], mut each: impl FnMut((u32, u32))) {
        let of = self.of(number);
        let row = of.stencil(row);
        let place = match row.corner {
            abi::STENCIL_OWN => None,
            corner => {
                let number = self.border.use_of_corner(corner) as usize;
                Some(of.place(self.border.used(number).ring, 0))
            }
        };
        each((place.map_or(vertices[0], |place| self.vertex(place)), 0));
        let compensated = vertices.len() > abi::CONTROL_INVOCATIONS as usize;
        for i in 0..vertices.len() {
            let place = of.order(i);
            let weight = row.weight(place);
            if weight != 0.0 || compensated {
                each((vertices[place], weight.to_bits()));
            }
        }
    }

    pub fn is_same(self, job: u32, other: Patch<'_>, others: u32) -> bool {
        let ((kind, number, row), (its_kind, its_number, its_row)) = (parts(job), parts(others));
        if kind != its_kind {
            return false;
        }
        match kind {
            abi::JOB_VERTEX => self.vertex(row) == other.vertex(its_row),
            abi::JOB_LIMIT => {
                let same_pass = std::ptr::eq(self.pass, other.pass);
                let same = self.corner_key(number) == other.corner_key(its_number);
                let (of, others) = (self.of(number), other.of(its_number));
                same_pass && same && of.vertices().eq(others.vertices())
            }
            _ => {
                if std::ptr::eq(self.pass, other.pass)
                    && (self.number, job) == (other.number, others)
                {
                    return true;
                }
                let mut terms: SmallVec<[(u32, u32); 64]> = SmallVec::new();
                let vertices: Vertices = self.of(number).vertices().collect();
                self.terms(number, row, &vertices, |term| terms.push(term));
                let (mut at, mut same) = (0, true);
                let vertices: Vertices = other.of(its_number).vertices().collect();
                other.terms(its_number, its_row, &vertices, |term| {
                    same &= terms.get(at) == Some(&term);
                    at += 1;
                });
                same && at == terms.len()
            }
        }
    }
}

impl PatchPoints {
    fn push(&mut self, patch: Patch<'_>, job: u32, level: u32) {
        let hash = patch.hash(job);
        self.needed.push(Needed { hash, job, level });
    }
}
