//! A cache of control points that is edited: points of patches that are other ones go or come, and all others keep their places.
//!
//! Points are there once for all patches that share them, as in `cached.rs`; one of these computes it. Where that patch goes another one takes over, and a point goes when
//! nobody needs it any more. Each pass has a block of places for each level, with some to spare: the job in a place of the block computes the point in the same place, and in
//! places that nobody has a job that harms nothing.

mod blocks;

use std::collections::BTreeSet;
use std::ops::Range;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::abi;
use crate::method::cached::{
    CacheChange, CacheEdits, CachedPass, CachedPoints, EditedPoints, Jobs,
};
use blocks::{Block, Change};

use crate::method::quadtree::cached::{Patch, PatchPoints, needed, patches, shared, with_normal};
use crate::method::{Pass, Prepared, Table, Update};

/// The numbers of a pass's tables.
const STARTS: usize = 0;
const PLACES: usize = 1;
const JOBS: usize = 2;

/// Computes the copy of a vertex that any patch has, a vacant one too: a place that nobody has.
const NOTHING: u32 = abi::JOB_VERTEX << abi::JOB_KIND_SHIFT;

/// A patch that needs a point: its pass and slot, the job by which it computes it, and the level from which on it is needed.
#[derive(Clone, Copy, Debug)]
struct User {
    pass: u32,
    slot: u32,
    job: u32,
    level: u32,
}

/// A point, or a limit with its normal behind it.
#[derive(Debug)]
struct Point {
    hash: u64,
    /// The first one computes it.
    users: SmallVec<[User; 2]>,
    place: Option<Place>,
}

/// Where a point is computed, and in how many places.
#[derive(Clone, Copy, Debug)]
struct Place {
    pass: usize,
    level: usize,
    /// In its block.
    at: u32,
    size: u32,
    products: u64,
}

/// Places that are vacant, by how many follow one another.
type Vacant = [Vec<u32>; 2];

/// See the top of this file.
#[derive(Debug, Default)]
struct Recached {
    deepest: u32,
    points: Vec<Point>,
    /// Numbers of points that nobody needs.
    free: Vec<u32>,
    known: FxHashMap<u64, SmallVec<[u32; 2]>>,
    /// By pass and slot, the points that the patch there needs, in their order.
    patches: Vec<Vec<Box<[u32]>>>,
    /// By pass and slot, where its words stand among the pass's places.
    lists: Vec<Vec<Range<u32>>>,
    /// By pass, where words stand that nobody reads, by how many.
    free_lists: Vec<FxHashMap<u32, Vec<u32>>>,
    /// By pass and level.
    blocks: Vec<Vec<Block>>,
    vacant: Vec<Vec<Vacant>>,
    /// By level, the products of a weight and a vertex.
    products: Vec<u64>,
}

/// What a cache holds up to a plan level, and what keeps it up with edits.
pub fn edited_points(prepared: &Prepared, deepest: u32) -> EditedPoints {
    let all = patches(prepared);
    let found = needed(&all, deepest);
    let (owned, numbers) = shared(prepared, &all, &found);
    let passes = prepared.passes.len();
    let levels = deepest as usize + 1;
    let slots = |pass: &Pass| match pass.cached {
        Some(_) => pass.patches.len(),
        None => 0,
    };
    let mut own = Recached {
        deepest,
        patches: prepared
            .passes
            .iter()
            .map(|pass| vec![Box::default(); slots(pass)])
            .collect(),
        lists: prepared
            .passes
            .iter()
            .map(|pass| vec![0..0; slots(pass)])
            .collect(),
        free_lists: vec![FxHashMap::default(); passes],
        blocks: vec![vec![Block::default(); levels]; passes],
        vacant: vec![vec![Vacant::default(); levels]; passes],
        products: vec![0; levels],
        ..Recached::default()
    };
    own.points.extend(owned.iter().map(|_| Point {
        hash: 0,
        users: SmallVec::new(),
        place: None,
    }));
    for ((&(pass, _, slot), found), numbers) in all.iter().zip(&found).zip(&numbers) {
        for (needed, &number) in found.needed.iter().zip(numbers) {
            let point = &mut own.points[number as usize];
            point.hash = needed.hash;
            point.users.push(User {
                pass: pass as u32,
                slot: slot as u32,
                job: needed.job,
                level: needed.level,
            });
        }
        own.patches[pass][slot] = numbers.as_slice().into();
    }
    for (number, point) in (0..).zip(&own.points) {
        own.known.entry(point.hash).or_default().push(number);
    }
    let mut made = CachedPoints {
        passes: vec![CachedPass::default(); passes],
        ..CachedPoints::default()
    };
    own.lay_out(&mut made);
    let mut change = Change::new(0);
    for number in 0..own.points.len() as u32 {
        let placed = own.place(number, prepared, &mut made, &mut change);
        placed.expect("there is room for what was counted");
    }
    for ((pass, _, slot), found) in all.into_iter().zip(&found) {
        own.write(pass, slot, found, &mut made, &mut change);
    }
    own.count(&mut made);
    (made, Box::new(own))
}

impl Recached {
    /// Divides the places among levels and passes: what there is, a quarter more, and some.
    fn lay_out(&mut self, made: &mut CachedPoints) {
        for point in &self.points {
            let (pass, level) = wanted(point);
            let count = with_normal(point.users[0].job).count() as u32;
            self.blocks[pass][level].room += count;
        }
        let mut next_job = vec![0; self.blocks.len()];
        let mut next_point = 0;
        for level in 0..=self.deepest as usize {
            for (pass, blocks) in self.blocks.iter_mut().enumerate() {
                let block = &mut blocks[level];
                if !self.patches[pass].is_empty() {
                    block.room += block.room / 4 + 256;
                }
                (block.first_job, block.first_point) = (next_job[pass], next_point);
                next_job[pass] += block.room;
                next_point += block.room;
            }
            made.ends[level] = next_point;
        }
        for level in 1..made.ends.len() {
            made.ends[level] = made.ends[level].max(made.ends[level - 1]);
        }
        for ((pass, patches), jobs) in made.passes.iter_mut().zip(&self.patches).zip(next_job) {
            if patches.is_empty() {
                continue;
            }
            let nothing = [0, NOTHING];
            pass.tables = vec![
                Table::of(&vec![0u32; patches.len()]),
                Table::of::<u32>(&[]),
                Table::of(&vec![nothing; jobs as usize]),
            ];
        }
    }

    /// Says what there is by level.
    fn count(&self, made: &mut CachedPoints) {
        for (pass, blocks) in made.passes.iter_mut().zip(&self.blocks) {
            for (jobs, block) in pass.jobs.iter_mut().zip(blocks) {
                *jobs = Jobs {
                    first: block.first_job,
                    count: block.used,
                    first_point: block.first_point,
                };
            }
        }
        let mut sum = 0;
        for (level, sums) in made.sums.iter_mut().enumerate() {
            sum += self.products.get(level).copied().unwrap_or(0);
            *sums = sum;
        }
    }

    /// Gives a point a place where it has none, or not where its first user and its least level want it; and has it computed. Tells whether it has another place now.
    fn place(
        &mut self,
        number: u32,
        prepared: &Prepared,
        made: &mut CachedPoints,
        change: &mut Change,
    ) -> Option<bool> {
        let point = &self.points[number as usize];
        let (pass, level) = wanted(point);
        let first = point.users[0];
        let jobs: SmallVec<[[u32; 2]; 2]> = with_normal(first.job)
            .map(|job| [first.slot, job])
            .collect();
        let stays = point
            .place
            .filter(|place| place.pass == pass && place.level <= level);
        let place = match stays {
            Some(place) => place,
            None => {
                self.leave(number, made, change);
                let owner = Patch::new(&prepared.passes[pass], first.slot as usize);
                let products = with_normal(first.job).map(|job| owner.products(job)).sum();
                let size = jobs.len() as u32;
                let at = self.take(pass, level, size)?;
                self.products[level] += products;
                let place = Place {
                    pass,
                    level,
                    at,
                    size,
                    products,
                };
                self.points[number as usize].place = Some(place);
                change.compute(pass, level, at..at + size);
                place
            }
        };
        let at = self.blocks[place.pass][place.level].first_job + place.at;
        let words: &[u32] = bytemuck::cast_slice(&jobs);
        change.write(made, (pass, JOBS, 2 * at as usize), words);
        Some(stays.is_none())
    }

    /// So many places of a block that follow one another.
    fn take(&mut self, pass: usize, level: usize, size: u32) -> Option<u32> {
        let (block, vacant) = (&mut self.blocks[pass][level], &mut self.vacant[pass][level]);
        if let Some(at) = vacant[size as usize - 1].pop() {
            return Some(at);
        }
        if block.used + size <= block.room {
            block.used += size;
            return Some(block.used - size);
        }
        // A pair for a single one.
        let pair = vacant[1].pop().filter(|_| size == 1)?;
        vacant[0].push(pair + 1);
        Some(pair)
    }

    /// Takes a point's place away.
    fn leave(&mut self, number: u32, made: &mut CachedPoints, change: &mut Change) {
        let Some(place) = self.points[number as usize].place.take() else {
            return;
        };
        self.products[place.level] -= place.products;
        self.vacant[place.pass][place.level][place.size as usize - 1].push(place.at);
        let at = self.blocks[place.pass][place.level].first_job + place.at;
        for i in 0..place.size {
            let word = 2 * (at + i) as usize;
            change.write(made, (place.pass, JOBS, word), &[0, NOTHING]);
        }
    }

    /// Writes where a patch finds its points.
    fn write(
        &mut self,
        pass: usize,
        slot: usize,
        found: &PatchPoints,
        made: &mut CachedPoints,
        change: &mut Change,
    ) {
        let known = self.lists[pass][slot].clone();
        let place = |needed: u32| {
            let number = self.patches[pass][slot][needed as usize];
            let place = self.points[number as usize].place;
            place.map_or(0, |place| {
                self.blocks[place.pass][place.level].first_point + place.at
            })
        };
        let count = if found.needed.is_empty() {
            0
        } else {
            found.words(0, place).len() as u32
        };
        let first = match known.len() as u32 == count {
            true => known.start,
            false => {
                let free = &mut self.free_lists[pass];
                if !known.is_empty() {
                    let count = known.len() as u32;
                    free.entry(count).or_default().push(known.start);
                }
                let vacant = free.get_mut(&count).and_then(Vec::pop);
                vacant.unwrap_or(made.passes[pass].tables[PLACES].len() as u32)
            }
        };
        if count > 0 {
            let words = found.words(first, place);
            change.write(made, (pass, PLACES, first as usize), &words);
        }
        change.write(made, (pass, STARTS, slot), &[first]);
        self.lists[pass][slot] = first..first + count;
    }

    /// Forgets what a patch needs; tells which points.
    fn forget(&mut self, pass: usize, slot: usize) -> Box<[u32]> {
        let numbers = std::mem::take(&mut self.patches[pass][slot]);
        for &number in &numbers {
            let users = &mut self.points[number as usize].users;
            users.retain(|user| (user.pass as usize, user.slot as usize) != (pass, slot));
        }
        numbers
    }

    /// Takes down what a patch needs: points that are there, or new ones.
    fn meet(&mut self, prepared: &Prepared, pass: usize, slot: usize, found: &PatchPoints) {
        let own = Patch::new(&prepared.passes[pass], slot);
        let numbers = found.needed.iter().map(|needed| {
            let points = &self.points;
            let candidates = self.known.entry(needed.hash).or_default();
            let is_it = |&&number: &&u32| {
                let owner = points[number as usize].users[0];
                let pass = &prepared.passes[owner.pass as usize];
                own.is_same(needed.job, Patch::new(pass, owner.slot as usize), owner.job)
            };
            let number = candidates.iter().find(is_it).copied();
            let number = number.unwrap_or_else(|| {
                let point = Point {
                    hash: needed.hash,
                    users: SmallVec::new(),
                    place: None,
                };
                let number = match self.free.pop() {
                    Some(number) => {
                        self.points[number as usize] = point;
                        number
                    }
                    None => {
                        self.points.push(point);
                        self.points.len() as u32 - 1
                    }
                };
                candidates.push(number);
                number
            });
            self.points[number as usize].users.push(User {
                pass: pass as u32,
                slot: slot as u32,
                job: needed.job,
                level: needed.level,
            });
            number
        });
        let numbers: Vec<u32> = numbers.collect();
        self.patches[pass][slot] = numbers.into();
    }

    /// Lets points go that nobody needs any more.
    fn drop_unused(
        &mut self,
        touched: &mut BTreeSet<u32>,
        made: &mut CachedPoints,
        change: &mut Change,
    ) {
        let points = &self.points;
        let unused: Vec<u32> = touched
            .iter()
            .copied()
            .filter(|&number| points[number as usize].users.is_empty())
            .collect();
        for number in unused {
            touched.remove(&number);
            self.leave(number, made, change);
            let hash = self.points[number as usize].hash;
            if let Some(known) = self.known.get_mut(&hash) {
                known.retain(|known| *known != number);
                if known.is_empty() {
                    self.known.remove(&hash);
                }
            }
            self.free.push(number);
        }
    }
}

/// The pass of the patch that computes a point, and the level from which on anyone needs it.
fn wanted(point: &Point) -> (usize, usize) {
    let level = point.users.iter().map(|user| user.level).min();
    (point.users[0].pass as usize, level.unwrap_or(0) as usize)
}

impl CacheEdits for Recached {
    fn edit(
        &mut self,
        made: &mut CachedPoints,
        prepared: &Prepared,
        update: &Update,
    ) -> Option<CacheChange> {
        let changed = update.passes.iter().enumerate().flat_map(|(pass, change)| {
            let cached = prepared.passes[pass].cached.is_some();
            let slots = change.slots().iter().filter(move |_| cached);
            slots.map(move |&slot| (pass, &prepared.passes[pass], slot as usize))
        });
        let changed: Vec<(usize, &Pass, usize)> = changed.collect();
        let mut change = Change::new(prepared.passes.len());
        let mut touched = BTreeSet::new();
        for &(pass, _, slot) in &changed {
            touched.extend(self.forget(pass, slot));
        }
        self.drop_unused(&mut touched, made, &mut change);
        let found = needed(&changed, self.deepest);
        for (&(pass, _, slot), found) in changed.iter().zip(&found) {
            self.meet(prepared, pass, slot, found);
            touched.extend(&self.patches[pass][slot]);
        }
        // Who else has a point that is somewhere else now looks for it there.
        let mut others: BTreeSet<(usize, usize)> = BTreeSet::new();
        for number in touched {
            if self.place(number, prepared, made, &mut change)? {
                let users = self.points[number as usize].users.iter();
                others.extend(users.map(|user| (user.pass as usize, user.slot as usize)));
            }
        }
        for (&(pass, _, slot), found) in changed.iter().zip(&found) {
            others.remove(&(pass, slot));
            self.write(pass, slot, found, made, &mut change);
        }
        let others = others
            .into_iter()
            .map(|(pass, slot)| (pass, &prepared.passes[pass], slot));
        let others: Vec<(usize, &Pass, usize)> = others.collect();
        let found = needed(&others, self.deepest);
        for (&(pass, _, slot), found) in others.iter().zip(&found) {
            self.write(pass, slot, found, made, &mut change);
        }
        self.count(made);
        Some(change.finish(&self.blocks))
    }
}
