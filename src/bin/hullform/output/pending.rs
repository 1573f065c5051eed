//! A file in the making.

use hullform::{Error, Result};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that is written beside its place and appears there when it is complete. Dropped before, it leaves nothing behind.
///
/// Made before the work begins, so that a folder one cannot write to is known then and not an hour later.
pub struct Pending {
    path: PathBuf,
    place: Place,
}

enum Place {
    /// Beside the file, to be renamed.
    Beside(NamedTempFile),
    /// Something that is there and no regular file (a device, a pipe): renaming would replace it, so it is written to.
    Direct(File),
}

impl Pending {
    /// Prepares to write `path`.
    pub fn create(path: &Path) -> Result<Pending> {
        let failed = |source| Error::File {
            path: path.into(),
            source,
        };
        Pending::open(path).map_err(failed)
    }

    fn open(path: &Path) -> io::Result<Pending> {
        // A link stays, and what it points to is replaced.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.into());
        let place = match fs::metadata(&path) {
            Ok(there) if !there.is_file() => {
                Place::Direct(File::options().write(true).open(&path)?)
            }
            _ => Place::Beside(beside(&path)?),
        };
        Ok(Pending { path, place })
    }

    /// Lets `write` write the contents, and puts the file in its place.
    pub fn write(self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
        let Pending { path, place } = self;
        let written = match place {
            Place::Direct(file) => buffered(&file, write),
            Place::Beside(file) => buffered(file.as_file(), write)
                .and_then(|()| file.persist(&path).map_err(|error| error.error))
                .map(drop),
        };
        written.map_err(|source| Error::File { path, source })
    }
}

fn buffered(file: &File, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut buffer = BufWriter::new(file);
    write(&mut buffer)?;
    buffer.flush()
}

fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    // Opened by ourselves: tempfile's own files are private, and its errors name the temporary file instead of the user's.
    let mut refused = None;
    let open = |path: &Path| {
        let opened = File::options().write(true).create_new(true).open(path);
        opened.inspect_err(|error| refused = error.raw_os_error())
    };
    let made = tempfile::Builder::new()
        .prefix(".hullform-")
        .make_in(folder, open);
    made.map_err(|error| refused.map_or(error, io::Error::from_raw_os_error))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("the folder is there");
        let name = |entry: io::Result<fs::DirEntry>| {
            let entry = entry.expect("an entry");
            entry.file_name().to_string_lossy().into_owned()
        };
        entries.map(name).collect()
    }

    #[test]
    fn a_file_appears_complete() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.txt");
        fs::write(&path, "old").expect("written");
        let pending = Pending::create(&path).expect("writable");
        assert_eq!(fs::read(&path).expect("readable"), b"old");
        pending
            .write(|file| file.write_all(b"new"))
            .expect("written");
        assert_eq!(fs::read(&path).expect("readable"), b"new");
        assert_eq!(names(folder.path()), ["out.txt"]);
    }

    #[test]
    fn a_failure_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.txt");
        let pending = Pending::create(&path).expect("writable");
        let failed = pending.write(|file| {
            file.write_all(b"half")?;
            Err(io::Error::other("disk full"))
        });
        let words = failed.expect_err("it failed").to_string();
        assert!(words.ends_with("out.txt: disk full"), "{words}");
        drop(Pending::create(&path).expect("writable"));
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_missing_folder_is_known_at_once() {
        let error = Pending::create(Path::new("/no/such/folder/out.txt")).err();
        let error = error.expect("there is no such folder");
        assert_eq!(error.exit_code(), 2);
        let words = error.to_string();
        assert!(words.starts_with("/no/such/folder/out.txt: "), "{words}");
        assert!(!words.contains(".hullform-"), "{words}");
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_links_stay_what_they_are() {
        use std::os::unix::fs::{FileTypeExt, symlink};
        let null = Path::new("/dev/null");
        let pending = Pending::create(null).expect("writable");
        pending.write(|file| file.write_all(b"x")).expect("written");
        let kind = fs::metadata(null).expect("there").file_type();
        assert!(kind.is_char_device());

        let folder = tempfile::tempdir().expect("a folder");
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        fs::write(&target, "old").expect("written");
        symlink(&target, &link).expect("linked");
        let pending = Pending::create(&link).expect("writable");
        pending
            .write(|file| file.write_all(b"new"))
            .expect("written");
        assert_eq!(fs::read(&target).expect("readable"), b"new");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    }
}
