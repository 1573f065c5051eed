//! A database on disk, shared by any number of processes.
//!
//! Whoever appends holds the file's lock (`flock`), and first reads what others appended; whoever prunes holds it too, and puts another file in its place, which
//! all others notice before they append. Nothing is promised before the system says that it is on disk.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;

use crate::error::{Error, Place, Result};
use crate::plan::database::records::{self, Beginning, HEADER};

/// How large a file grows, in bytes.
pub const GREATEST_BYTES: u64 = 256 << 20;

/// Records with less than that between them are read together, up to so many bytes.
const GAP: u64 = 1 << 16;
const AT_ONCE: u64 = 1 << 22;

/// An open database file.
#[derive(Debug)]
pub struct PlanFile {
    path: PathBuf,
    file: File,
    /// Where the records of keys are.
    places: FxHashMap<Box<[u32]>, Range<u64>>,
    /// How far it was read.
    read: u64,
    /// Bytes of no record.
    lost: u64,
    /// Records whose key a later one has.
    repeated: usize,
}

impl PlanFile {
    /// Opens a database, or begins one; of one of another version a new one is begun in its place.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read or written; [`Error::Input`] for a file that is something else, which is left as it is.
    pub fn open(path: &Path) -> Result<PlanFile> {
        let error = |source| Error::File {
            path: path.into(),
            source,
        };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(error)?;
        }
        let mut opened = PlanFile {
            path: path.into(),
            file: open(path).map_err(error)?,
            places: FxHashMap::default(),
            read: 0,
            lost: 0,
            repeated: 0,
        };
        opened.file.lock().map_err(error)?;
        let begun = opened.begin();
        // Closing it would as well.
        let _ = opened.file.unlock();
        match begun.map_err(error)? {
            Beginning::Foreign => Err(Error::input(
                Place::File(path.display().to_string()),
                "this is no database of plans, or its header is damaged",
                "name another file with --db, or move this one away",
            )),
            _ => Ok(opened),
        }
    }

    /// Sees to it that there is a header, and reads all.
    fn begin(&mut self) -> std::io::Result<Beginning> {
        let mut head = Vec::new();
        self.file.seek(SeekFrom::Start(0))?;
        Read::by_ref(&mut self.file)
            .take(HEADER as u64)
            .read_to_end(&mut head)?;
        let beginning = records::beginning(&head);
        match beginning {
            Beginning::Foreign => return Ok(beginning),
            Beginning::Sound => {}
            Beginning::Empty | Beginning::Version(_) => {
                if let Beginning::Version(version) = beginning {
                    tracing::warn!(
                        "{}: a database of version {version}, and not {}: it is begun anew",
                        self.path.display(),
                        records::VERSION
                    );
                }
                self.file.set_len(0)?;
                self.file.seek(SeekFrom::Start(0))?;
                self.file.write_all(&records::header())?;
                self.file.sync_all()?;
            }
        }
        self.read = HEADER as u64;
        self.catch_up()?;
        Ok(Beginning::Sound)
    }

    /// Reads what was appended since.
    fn catch_up(&mut self) -> std::io::Result<()> {
        self.file.seek(SeekFrom::Start(self.read))?;
        let mut bytes = Vec::new();
        self.file.read_to_end(&mut bytes)?;
        let (found, lost) = records::scan(&bytes, 0);
        self.lost += lost as u64;
        for range in found {
            let Some(key) = records::key(&bytes[range.clone()]) else {
                continue;
            };
            let place = self.read + range.start as u64..self.read + range.end as u64;
            // The latest counts: it may have been appended because an earlier one made no sense.
            let earlier = self.places.insert(key, place);
            self.repeated += usize::from(earlier.is_some());
        }
        self.read += bytes.len() as u64;
        Ok(())
    }

    /// The words of the entry of a key; None where there is none, or what is there now is none any more.
    pub fn find(&mut self, key: &[u32]) -> Option<Vec<u32>> {
        self.find_all(&[key.to_vec()]).pop()?
    }

    /// The same of many keys: what stands side by side is read at once.
    pub fn find_all(&mut self, keys: &[Vec<u32>]) -> Vec<Option<Vec<u32>>> {
        let places = keys.iter().map(|key| self.places.get(&key[..]).cloned());
        let places: Vec<Option<Range<u64>>> = places.collect();
        let mut order: Vec<usize> = (0..keys.len()).filter(|&i| places[i].is_some()).collect();
        let place = |i: usize| places[i].clone().unwrap_or_default();
        order.sort_unstable_by_key(|&i| place(i).start);
        let mut found = vec![None; keys.len()];
        let mut bytes = Vec::new();
        let mut rest = &order[..];
        while let Some(&first) = rest.first() {
            let start = place(first).start;
            let near = |pair: &[usize]| {
                let next = place(pair[1]);
                next.start <= place(pair[0]).end + GAP && next.end <= start + AT_ONCE
            };
            let count = 1 + rest.windows(2).take_while(|pair| near(pair)).count();
            let (group, behind) = rest.split_at(count);
            rest = behind;
            let end = place(group[count - 1]).end;
            bytes.resize((end - start) as usize, 0);
            let read = self.file.seek(SeekFrom::Start(start));
            let read = read.and_then(|_| self.file.read_exact(&mut bytes));
            for &i in group {
                let own = place(i);
                let own = (own.start - start) as usize..(own.end - start) as usize;
                let entry = read.is_ok().then(|| records::entry(&bytes[own], &keys[i]));
                found[i] = entry.flatten();
                if found[i].is_none() {
                    self.damaged(&keys[i]);
                }
            }
        }
        found
    }

    fn damaged(&mut self, key: &[u32]) {
        tracing::warn!(
            "{}: an entry was damaged since it was read; it is built anew",
            self.path.display()
        );
        self.places.remove(key);
    }

    /// Forgets an entry that is not sound, so that one that is can be appended.
    pub fn forget(&mut self, key: &[u32]) {
        tracing::warn!(
            "{}: an entry makes no sense; it is built anew",
            self.path.display()
        );
        self.places.remove(key);
    }

    /// Appends entries that it has not. They are on disk when this returns.
    ///
    /// # Errors
    /// The system's, and [`ErrorKind::StorageFull`] where the file would grow beyond [`GREATEST_BYTES`]. What was appended before stays, and no other.
    pub fn append(&mut self, entries: &[(Vec<u32>, Vec<u32>)]) -> std::io::Result<()> {
        self.file.lock()?;
        let appended = self.append_locked(entries);
        let unlocked = self.file.unlock();
        appended.and(unlocked)
    }

    fn append_locked(&mut self, entries: &[(Vec<u32>, Vec<u32>)]) -> std::io::Result<()> {
        self.follow()?;
        self.catch_up()?;
        let mut bytes = Vec::new();
        for (key, entry) in entries {
            if !self.places.contains_key(&key[..]) {
                bytes.extend(records::record(key, entry));
            }
        }
        if bytes.is_empty() {
            return Ok(());
        }
        let end = self.read.next_multiple_of(4);
        if end + bytes.len() as u64 > GREATEST_BYTES {
            return Err(ErrorKind::StorageFull.into());
        }
        let start = self.read;
        let written = self.file.seek(SeekFrom::Start(end)).and_then(|_| {
            self.file.set_len(end)?;
            self.file.write_all(&bytes)?;
            self.file.sync_data()
        });
        if written.is_err() {
            // As good as it goes: what cannot be taken back is no record, and is passed over.
            let _ = self.file.set_len(start);
            return written;
        }
        self.catch_up()
    }

    /// Turns to the file that another process may have put in the place of the open one, under the lock of both.
    fn follow(&mut self) -> std::io::Result<()> {
        loop {
            let mut new = open(&self.path)?;
            if is_same(&self.file, &new)? {
                return Ok(());
            }
            new.lock()?;
            std::mem::swap(&mut self.file, &mut new);
            // The old one goes, and its lock with it.
            drop(new);
            (self.places, self.read, self.lost, self.repeated) = Default::default();
            if self.begin()? == Beginning::Foreign {
                return Err(ErrorKind::InvalidData.into());
            }
        }
    }

    /// Writes all entries that `keep` wants into a new file, in the order in which they were appended, and puts it in this one's place.
    ///
    /// # Errors
    /// The system's; the old file stays then.
    pub fn rewrite(&mut self, mut keep: impl FnMut(&[u32], &[u32]) -> bool) -> std::io::Result<()> {
        self.file.lock()?;
        self.follow()?;
        self.catch_up()?;
        let mut bytes = records::header().to_vec();
        for key in self.keys() {
            if let Some(entry) = self.find(&key)
                && keep(&key, &entry)
            {
                bytes.extend(records::record(&key, &entry));
            }
        }
        let beside = self
            .path
            .with_extension(format!("{}.part", std::process::id()));
        let written = File::create(&beside).and_then(|mut file| {
            file.write_all(&bytes)?;
            file.sync_all()?;
            std::fs::rename(&beside, &self.path)
        });
        if written.is_err() {
            let _ = std::fs::remove_file(&beside);
        }
        let _ = self.file.unlock();
        written?;
        self.file.lock()?;
        let followed = self.follow();
        let _ = self.file.unlock();
        followed
    }

    /// All keys, in the order of their records.
    pub fn keys(&self) -> Vec<Box<[u32]>> {
        let mut keys: Vec<_> = self.places.iter().collect();
        keys.sort_by_key(|(_, place)| place.start);
        keys.into_iter().map(|(key, _)| key.clone()).collect()
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its bytes; those that belong to no record; and how many records repeat an earlier one.
    pub fn state(&self) -> (u64, u64, usize) {
        (self.read, self.lost, self.repeated)
    }
}

fn open(path: &Path) -> std::io::Result<File> {
    let mut options = OpenOptions::new();
    options
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)
}

/// Whether two open files are one.
fn is_same(one: &File, other: &File) -> std::io::Result<bool> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let number = |file: &File| file.metadata().map(|data| (data.dev(), data.ino()));
        Ok(number(one)? == number(other)?)
    }
    #[cfg(not(unix))]
    {
        // Elsewhere a file that is open cannot be replaced.
        let _ = (one, other);
        Ok(true)
    }
}
