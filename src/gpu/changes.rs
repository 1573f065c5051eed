//! Tables that an edit has changed, on the device: only the words that are other ones, in the order of the queue.
//!
//! The frames that the queue has before see what was there: the writes wait for them, and what is drawn later waits for the writes (Vulkan spec,
//! "Synchronization and Cache Control"), so neither host nor engine does. Bytes travel within the command buffer (`vkCmdUpdateBuffer`): there is no staging
//! memory that would have to outlive the frame. Rejected: a copy of all tables for each frame in flight, which is megabytes for a crease.

use std::ops::Range;

use ash::vk;

use crate::error::{Error, Misuse, Result};
use crate::frame::Decides;
use crate::gpu::barrier::{MOST_UPDATED, cmd_make_visible};
use crate::gpu::bound::Bound;
use crate::gpu::kept_cache::CacheWords;
use crate::method::{CachedPoints, Pass, Prepared, Table, Update, deciding_tables};

/// Writes that are no farther apart than this are one: a command costs more than a few words.
const NEAR: usize = 64;

/// What tables have that can be edited.
#[derive(Debug, Default)]
pub(super) struct Edited {
    /// By pass, the tables' words in its buffer, with the room that each has.
    pub rooms: Vec<Vec<Range<usize>>>,
    /// By pass, the numbers of the buffers.
    pub buffers: Vec<usize>,
    /// By pass, what the device decides by, where it decides.
    pub deciding: Vec<[Table; 3]>,
    /// By pass: tables and words that are to be written.
    pending: Vec<Vec<(usize, Range<usize>)>>,
}

/// Where the tables of cached points stand.
const CACHED: usize = 3 + crate::abi::TABLES as usize;
/// Where the tables stand that the device decides by.
const DECIDING: usize = CACHED + crate::abi::CACHED_TABLES as usize;

/// Refuses an update that is not for these tables, or cannot be carried out in place.
///
/// # Errors
/// [`Misuse::OtherSurface`].
pub(super) fn check(own: &Prepared, edited: &Prepared, update: &Update) -> Result<()> {
    let is_next = own.version() == update.before() && edited.version() == update.before() + 1;
    if update.is_whole || own.number() != edited.number() || !is_next {
        return Err(Error::Misuse(Misuse::OtherSurface));
    }
    Ok(())
}

impl Edited {
    /// Takes down what an update has changed in `prepared` and in the tables of cached points, if all of it has room; else nothing, and tells so.
    pub fn take(
        &mut self,
        prepared: &Prepared,
        update: &Update,
        cache: CacheWords,
        decides: Decides,
    ) -> bool {
        let changes = update.passes.iter().map(|change| change.ranges().collect());
        let mut changes: Vec<Vec<(usize, Range<usize>)>> = changes.collect();
        // Nothing is said of passes where nothing has changed.
        changes.resize(prepared.passes.len(), Vec::new());
        for (changes, cached) in changes.iter_mut().zip(cache) {
            let cached = cached.into_iter();
            changes.extend(cached.map(|(table, range)| (CACHED + table, range)));
        }
        let mut deciding = Vec::new();
        if decides == Decides::Device {
            for (number, changes) in changes.iter_mut().enumerate() {
                let tables = deciding_tables(prepared, number);
                for (table, (new, old)) in tables.iter().zip(&self.deciding[number]).enumerate() {
                    let differing = differing(new, old);
                    changes.extend(differing.map(|range| (DECIDING + table, range)));
                }
                deciding.push(tables);
            }
        }
        let mut rooms = self.rooms.iter().zip(&changes);
        let has_room = rooms.all(|(rooms, changes)| {
            let fits = |(table, range): &(usize, Range<usize>)| range.end <= rooms[*table].len();
            changes.iter().all(fits)
        });
        if !has_room {
            return false;
        }
        self.pending.resize(changes.len(), Vec::new());
        let pending = self.pending.iter_mut().zip(changes);
        pending.for_each(|(pending, changes)| pending.extend(changes));
        self.deciding = deciding;
        true
    }

    /// Records the writes that are due, after what earlier commands of the queue still read, and before whatever reads next in the stages `readers`.
    ///
    /// # Safety
    /// `cmd` is recording on `device`, outside of a render pass; the buffers are those of `bound`, and what was prepared and cached is what they are of.
    pub unsafe fn cmd_write(
        &mut self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        bound: &Bound,
        (prepared, points): (&Prepared, Option<&CachedPoints>),
        readers: vk::PipelineStageFlags,
    ) {
        let pending = std::mem::take(&mut self.pending);
        if pending.iter().all(Vec::is_empty) {
            return;
        }
        let transfer = vk::PipelineStageFlags::TRANSFER;
        let (write, read) = (
            vk::AccessFlags::TRANSFER_WRITE,
            vk::AccessFlags::SHADER_READ | vk::AccessFlags::UNIFORM_READ,
        );
        // SAFETY: this function's contract, here and below.
        unsafe { cmd_make_visible(device, cmd, readers | transfer, transfer, write) };
        for (number, pending) in pending.into_iter().enumerate() {
            let buffer = bound.buffer(self.buffers[number]).raw();
            for (table, range) in merged(pending) {
                let words = match (table.checked_sub(DECIDING), table.checked_sub(CACHED)) {
                    (Some(deciding), _) => &self.deciding[number][deciding],
                    (None, Some(cached)) => {
                        points.map_or(&[][..], |points| &points.passes[number].tables[cached])
                    }
                    (None, None) => words_of(&prepared.passes[number], table),
                };
                let words = &words[range.clone()];
                let first = 4 * (self.rooms[number][table].start + range.start) as u64;
                let parts = bytemuck::cast_slice(words).chunks(MOST_UPDATED);
                for (part, bytes) in (0u64..).zip(parts) {
                    let offset = first + part * MOST_UPDATED as u64;
                    // SAFETY: as above; the words are within their table's room, and so within the buffer.
                    unsafe { device.cmd_update_buffer(cmd, buffer, offset, bytes) };
                }
            }
        }
        // SAFETY: as above.
        unsafe { cmd_make_visible(device, cmd, transfer, readers, read) };
    }
}

/// The words of a table of a pass, by the numbers that [`PassChange`](crate::method::PassChange) gives them.
fn words_of(pass: &Pass, table: usize) -> &[u32] {
    match table {
        0 => bytemuck::cast_slice(&pass.patches),
        1 => &pass.controls,
        2 => bytemuck::cast_slice(&pass.texture),
        own => &pass.tables[own - 3],
    }
}

/// From the first word to the last that two lists of words differ in; all that one has and the other not. Nothing where they are alike.
fn differing(new: &[u32], old: &[u32]) -> impl Iterator<Item = Range<usize>> {
    let same = new
        .iter()
        .zip(old)
        .take_while(|(new, old)| new == old)
        .count();
    let range = match new.len() == old.len() {
        true => {
            let alike = new.iter().rev().zip(old.iter().rev());
            let alike = alike.take_while(|(new, old)| new == old).count();
            same..(new.len() - alike).max(same)
        }
        false => same..new.len(),
    };
    std::iter::once(range).filter(|range| !range.is_empty())
}

/// Ranges of each table that do not overlap, in their order.
fn merged(mut all: Vec<(usize, Range<usize>)>) -> Vec<(usize, Range<usize>)> {
    all.sort_unstable_by_key(|(table, range)| (*table, range.start));
    let mut merged: Vec<(usize, Range<usize>)> = Vec::new();
    for (table, range) in all {
        match merged.last_mut() {
            Some((of, last)) if *of == table && range.start <= last.end + NEAR => {
                last.end = last.end.max(range.end);
            }
            _ => merged.push((table, range)),
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_are_joined_where_they_meet_and_stay_apart_elsewhere() {
        let all = vec![(1, 500..510), (0, 0..5), (1, 0..4), (1, 2..8), (1, 20..30)];
        assert_eq!(merged(all), [(0, 0..5), (1, 0..30), (1, 500..510)]);
        let of = |new: &[u32], old: &[u32]| differing(new, old).next();
        assert_eq!(of(&[1, 2, 3, 4], &[1, 9, 8, 4]), Some(1..3));
        assert_eq!(of(&[1, 2, 3], &[1, 2]), Some(2..3));
        assert_eq!(of(&[1, 2], &[1, 2]), None);
        assert_eq!(of(&[1, 2, 2, 2], &[1, 2, 2, 1]), Some(3..4));
    }
}
