//! A file without a place.
//!
//! On Linux it has no name either (O_TMPFILE), so that nothing can leave it behind, not even SIGKILL, until it is linked to its place. Where
//! the file system has no such files it is a hidden file beside the place, which signals remove.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// The hidden files that are there.
///
/// Files come, go and are put in their places under its lock. Who holds it may end the process.
static HIDDEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Keeps all temporary files as they are.
pub type Still = MutexGuard<'static, Vec<PathBuf>>;

/// Nothing is made, placed or removed by others while the result lives.
pub fn still() -> Still {
    HIDDEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all hidden files; for a process that ends before it lets go of the result.
pub fn remove_unfinished() -> Still {
    let hidden = still();
    for path in hidden.iter() {
        // Nobody is there to hear of a failure.
        let _ = fs::remove_file(path);
    }
    hidden
}

/// A file that is complete before it has a place, or goes.
pub enum Temporary {
    /// Without a name.
    #[cfg(target_os = "linux")]
    Unnamed(File),
    /// A hidden file, listed in [`HIDDEN`].
    Hidden(Hidden),
}

/// A hidden file; only its end takes it away.
pub struct Hidden(Option<NamedTempFile>);

impl Temporary {
    /// A new file that can have a place in `folder`.
    pub fn new(folder: &Path) -> io::Result<Temporary> {
        #[cfg(target_os = "linux")]
        if let Ok(file) = linux::unnamed(folder) {
            return Ok(Temporary::Unnamed(file));
        }
        Hidden::new(folder, &mut still()).map(Temporary::Hidden)
    }

    /// The file.
    pub fn file(&self) -> &File {
        match self {
            #[cfg(target_os = "linux")]
            Temporary::Unnamed(file) => file,
            Temporary::Hidden(hidden) => hidden.file().as_file(),
        }
    }

    /// Puts it where `path` says, in the place of what is there.
    pub fn place(self, path: &Path, still: &mut Still) -> io::Result<()> {
        match self {
            #[cfg(target_os = "linux")]
            Temporary::Unnamed(file) => linux::place(file, path, still),
            Temporary::Hidden(hidden) => hidden.place(path, still),
        }
    }
}

impl Hidden {
    fn new(folder: &Path, still: &mut Still) -> io::Result<Hidden> {
        // Opened by ourselves: tempfile's own files are private, and its errors name the temporary file instead of the user's.
        let mut refused = None;
        let open = |path: &Path| {
            let opened = File::options().write(true).create_new(true).open(path);
            opened.inspect_err(|error| refused = error.raw_os_error())
        };
        let made = builder().make_in(folder, open);
        let made = made.map_err(|error| refused.map_or(error, io::Error::from_raw_os_error))?;
        still.push(made.path().into());
        Ok(Hidden(Some(made)))
    }

    fn file(&self) -> &NamedTempFile {
        self.0.as_ref().expect("there until it is placed")
    }

    fn place(mut self, path: &Path, still: &mut Still) -> io::Result<()> {
        let file = self.0.take().expect("there until it is placed");
        still.retain(|hidden| hidden != file.path());
        // A failure returns the file and so removes it.
        file.persist(path).map_err(|error| error.error).map(drop)
    }
}

impl Drop for Hidden {
    fn drop(&mut self) {
        if let Some(file) = self.0.take() {
            still().retain(|hidden| hidden != file.path());
        }
    }
}

fn builder() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".hullform-");
    builder
}

#[cfg(target_os = "linux")]
mod linux {
    use super::*;
    use rustix::fs::{AtFlags, CWD, OFlags, linkat};
    use rustix::io::Errno;
    use std::io::Seek;
    use std::os::fd::AsRawFd;
    use std::os::unix::fs::OpenOptionsExt;

    /// A file in `folder` that has no name; only with `/proc`, by which it gets one.
    pub fn unnamed(folder: &Path) -> io::Result<File> {
        let mut options = File::options();
        let flags = OFlags::TMPFILE.bits() as i32;
        options.read(true).write(true).custom_flags(flags);
        let file = options.open(folder)?;
        fs::symlink_metadata(by_number(&file))?;
        Ok(file)
    }

    /// Its name among this process's open files.
    fn by_number(file: &File) -> PathBuf {
        format!("/proc/self/fd/{}", file.as_raw_fd()).into()
    }

    /// A second name for an open file (open(2), at O_TMPFILE). It replaces nothing.
    fn link(file: &File, path: &Path) -> rustix::io::Result<()> {
        linkat(CWD, by_number(file), CWD, path, AtFlags::SYMLINK_FOLLOW)
    }

    pub fn place(file: File, path: &Path, still: &mut Still) -> io::Result<()> {
        match link(&file, path) {
            Ok(()) => Ok(()),
            Err(Errno::EXIST) => {
                let folder = path.parent().unwrap_or(Path::new("."));
                let hidden = builder().make_in(folder, |path| Ok(link(&file, path)?))?;
                hidden.persist(path).map_err(|error| error.error).map(drop)
            }
            // A file system that makes such files and cannot link them.
            Err(_) => copied(file, path, still)?.place(path, still),
        }
    }

    /// The same as a hidden file.
    pub fn copied(mut file: File, path: &Path, still: &mut Still) -> io::Result<Hidden> {
        let folder = path.parent().unwrap_or(Path::new("."));
        let hidden = Hidden::new(folder, still)?;
        file.rewind()?;
        let mut copy = hidden.file().as_file();
        let copied = io::copy(&mut file, &mut copy)
            .and_then(|_| copy.set_permissions(file.metadata()?.permissions()))
            .and_then(|()| copy.sync_all());
        match copied {
            Ok(()) => Ok(hidden),
            Err(error) => Err(hidden.gone(error, still)),
        }
    }

    impl Hidden {
        /// Removed, while others are kept still; and why.
        fn gone(mut self, why: io::Error, still: &mut Still) -> io::Error {
            if let Some(file) = self.0.take() {
                still.retain(|hidden| hidden != file.path());
            }
            why
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::names;
    use std::io::Write;

    /// Each kind, whatever the file system of the test has.
    fn kinds(folder: &Path) -> Vec<Temporary> {
        let hidden = Hidden::new(folder, &mut still()).expect("writable");
        let mut kinds = vec![Temporary::Hidden(hidden)];
        #[cfg(target_os = "linux")]
        kinds.extend(linux::unnamed(folder).map(Temporary::Unnamed));
        kinds
    }

    #[test]
    fn each_kind_takes_an_empty_or_taken_place() {
        for old in [None, Some("old")] {
            let folder = tempfile::tempdir().expect("a folder");
            for (i, made) in kinds(folder.path()).into_iter().enumerate() {
                let path = folder.path().join(format!("out-{i}"));
                if let Some(old) = old {
                    fs::write(&path, old).expect("written");
                }
                made.file().write_all(b"new").expect("written");
                made.place(&path, &mut still()).expect("placed");
                assert_eq!(fs::read(&path).expect("readable"), b"new");
            }
            assert!(
                names(folder.path())
                    .iter()
                    .all(|name| name.starts_with("out"))
            );
        }
    }

    #[test]
    fn what_is_dropped_or_cannot_be_placed_goes() {
        let folder = tempfile::tempdir().expect("a folder");
        drop(kinds(folder.path()));
        for made in kinds(folder.path()) {
            let path = folder.path().join("no/such/folder/out");
            assert!(made.place(&path, &mut still()).is_err());
        }
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn files_that_cannot_be_linked_are_copied() {
        let folder = tempfile::tempdir().expect("a folder");
        let Ok(mut file) = linux::unnamed(folder.path()) else {
            println!("skipped: no files without names here");
            return;
        };
        file.write_all(b"new").expect("written");
        let path = folder.path().join("out");
        let copied = linux::copied(file, &path, &mut still()).expect("copied");
        copied.place(&path, &mut still()).expect("placed");
        assert_eq!(fs::read(&path).expect("readable"), b"new");
        assert_eq!(names(folder.path()), ["out"]);
    }
}
