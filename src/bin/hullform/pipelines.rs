//! What the driver keeps of pipelines that it has built, kept from run to run.
//!
//! It is there to save time, so nothing about its files makes a run fail: what cannot be read is built anew, and what cannot be written is said in the log.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{fs, io};

use hullform::Result;
use hullform::host::{Device, PipelineCache};

use crate::{output, places};

/// What files begin with; then comes a check sum of the rest, which is the driver's.
const MAGIC: &[u8] = b"hullform pipelines 1\n";

/// Larger files are not read: something else is wrong with them.
const MOST: u64 = 256 << 20;

/// A cache with the file that it comes from and goes to.
#[derive(Clone)]
pub struct Kept {
    cache: Arc<PipelineCache>,
    path: PathBuf,
    /// What the file holds.
    loaded: Vec<u8>,
}

/// Where caches are kept: in the folder of the option, in none at all if that is `none`, and without it where all of a user's are.
pub fn folder(option: Option<&Path>) -> Option<PathBuf> {
    match option {
        Some(none) if none == Path::new("none") => None,
        Some(folder) => Some(folder.into()),
        None => places::caches(),
    }
}

impl Kept {
    /// The cache of a device in a folder; there is a file for each device and driver.
    pub fn open(device: &Device, folder: &Path) -> Result<Kept> {
        // SAFETY: no data at all.
        let empty = unsafe { PipelineCache::new(device, &[]) }?;
        let path = folder.join(format!("pipelines-{}", empty.origin()));
        let loaded = read(&path).unwrap_or_else(|problem| {
            tracing::debug!("{}: {problem}; pipelines are built anew", path.display());
            Vec::new()
        });
        // SAFETY: the check sum says that they are what a driver gave.
        let cache = unsafe { PipelineCache::new(device, &loaded) }?;
        Ok(Kept {
            cache: Arc::new(cache),
            path,
            loaded,
        })
    }

    /// The cache, for benches.
    pub fn cache(&self) -> Arc<PipelineCache> {
        self.cache.clone()
    }

    /// Writes what is new in it.
    pub fn keep(&self) -> Result<()> {
        let data = self.cache.data()?;
        if data != self.loaded
            && let Err(problem) = output::replace(&self.path, &closed(&data))
        {
            tracing::info!("{}: {problem}; pipelines are not kept", self.path.display());
        }
        Ok(())
    }
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    if fs::metadata(path)?.len() > MOST {
        return Err(io::Error::other("too large"));
    }
    let bytes = fs::read(path)?;
    opened(&bytes)
        .map(<[u8]>::to_vec)
        .ok_or_else(|| io::Error::other("damaged, or not ours"))
}

/// A file's bytes.
fn closed(data: &[u8]) -> Vec<u8> {
    [MAGIC, &crc32fast::hash(data).to_le_bytes(), data].concat()
}

/// The data in a file's bytes, if these are whole.
fn opened(bytes: &[u8]) -> Option<&[u8]> {
    let (sum, data) = bytes.strip_prefix(MAGIC)?.split_first_chunk()?;
    (u32::from_le_bytes(*sum) == crc32fast::hash(data)).then_some(data)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_with_any_byte_changed_cut_off_or_added_is_not_opened() {
        let data: Vec<u8> = (0..200).map(|i| (i * 37) as u8).collect();
        let file = closed(&data);
        assert_eq!(opened(&file), Some(&data[..]));
        for place in 0..file.len() {
            assert_eq!(opened(&file[..place]), None, "cut at {place}");
            for bit in 0..8 {
                let mut changed = file.clone();
                changed[place] ^= 1 << bit;
                assert_eq!(opened(&changed), None, "byte {place}");
            }
        }
        assert_eq!(opened(&[&file[..], &[0]].concat()), None);
    }
}
