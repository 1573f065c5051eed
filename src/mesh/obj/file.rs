//! Files as bytes, as many as make sense.

use std::fs::{File, Metadata};
use std::io::{self, IsTerminal, Read};
use std::path::Path;

use crate::error::{Error, Place, Result};

/// The greatest file that is read: some twenty million faces. Plans of more would fit no device.
const GREATEST_FILE: u64 = 4 << 30;

/// The most that is read of what cannot tell its size, such as a pipe.
const GREATEST_STREAM: u64 = 1 << 30;

/// All of a file or pipe.
pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    let failed = |source| Error::File {
        path: path.to_path_buf(),
        source,
    };
    let refused = |problem: String, remedy: &str| {
        Error::input(Place::File(path.display().to_string()), problem, remedy)
    };
    let file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    if is_device(&metadata) && !file.is_terminal() {
        return Err(refused(
            "it is a device, which need not have an end".into(),
            "name an OBJ file or a pipe, or /dev/stdin with either",
        ));
    }
    let (limit, expected, what) = match metadata.is_file() {
        true => (GREATEST_FILE, metadata.len(), "files"),
        false => (GREATEST_STREAM, 0, "pipes"),
    };
    let too_much = |size: String| {
        refused(
            format!("it has {size} bytes, but of {what} at most {limit} are read"),
            "split the model, or leave out what is no `v`, `vt`, `f` or `t` statement",
        )
    };
    if expected > limit {
        return Err(too_much(expected.to_string()));
    }
    let bytes = read_at_most(file, limit, expected).map_err(failed)?;
    bytes.ok_or_else(|| too_much(format!("more than {limit}")))
}

/// All of it, which is probably so much; None where there is more than the limit.
fn read_at_most(source: impl Read, limit: u64, expected: u64) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    // Memory that is not there is an error and not the program's end.
    bytes.try_reserve_exact(expected as usize + 1)?;
    source.take(limit + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}

#[cfg(unix)]
fn is_device(metadata: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = metadata.file_type();
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: &Metadata) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_end_is_read_to_the_limit_and_no_further() {
        let read = |limit| read_at_most(io::repeat(b'v').take(1000), limit, 0);
        assert!(read(999).expect("memory").is_none());
        assert_eq!(
            read(1000).expect("memory").map(|bytes| bytes.len()),
            Some(1000)
        );
        assert!(
            read_at_most(io::repeat(0), 5000, 7)
                .expect("memory")
                .is_none()
        );
        assert!(read_at_most(io::empty(), 5000, u64::MAX / 4).is_err());
    }
}
