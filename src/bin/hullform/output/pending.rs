//! A file in the making.

use super::target::{self, Identity, Target};
use super::temporary::{Temporary, still};
use hullform::{Error, Result};
use std::fs::{File, Metadata};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that has no place until it is complete. Dropped before, it leaves nothing behind.
///
/// Made before the work begins, so that a folder one cannot write to is known then and not an hour later.
///
/// A symbolic link stays, and what it leads to is written, even if that is not there yet. A file that is there keeps its mode and, if we may
/// give them, its owner and group; one that may not be written to is not replaced. It is a new file all the same: other names of the old one (hard
/// links) keep the old contents.
pub struct Pending {
    /// As the user has it.
    path: PathBuf,
    place: Place,
}

enum Place {
    /// The temporary file, where it goes, and what is there already.
    File(Temporary, PathBuf, Option<Box<Metadata>>),
    /// Something that is no regular file, and is written to.
    Stream(File),
}

/// A file that is written and on the disk, and has no place yet; or whatever else was written to.
struct Filled {
    path: PathBuf,
    file: Option<(Temporary, PathBuf)>,
}

/// Prepares to write files, of each the option that names it. None of them may be another one or one that is read, by whatever name.
pub fn create(reads: &[&Path], writes: &[(&'static str, &Path)]) -> Result<Vec<Pending>> {
    let mut taken: Vec<(Identity, String)> = Vec::new();
    for path in reads {
        let identity = Identity::of(path);
        taken.extend(identity.map(|identity| (identity, "what is read".into())));
    }
    let printed = target::stdout().and_then(|file| Identity::of_open(&file));
    taken.extend(printed.map(|identity| (identity, "where standard output goes".into())));
    let mut made = Vec::new();
    for &(option, path) in writes {
        let target = Target::of(path).map_err(|source| not_made(path, source))?;
        if let Some(identity) = target.identity() {
            if let Some((_, what)) = taken.iter().find(|(other, _)| *other == identity) {
                return Err(Error::Option {
                    option,
                    problem: format!("{} is {what}", path.display()),
                    remedy: "choose another name".into(),
                });
            }
            taken.push((identity, format!("what {option} writes")));
        }
        made.push(Pending::new(path, target).map_err(|source| not_made(path, source))?);
    }
    Ok(made)
}

impl Pending {
    fn new(path: &Path, target: Target) -> io::Result<Pending> {
        let place = match target {
            Target::File(place, there) => {
                Place::File(Temporary::new(target::folder(&place))?, place, there)
            }
            Target::Stream(file) => Place::Stream(file),
        };
        let path = path.into();
        Ok(Pending { path, place })
    }

    /// Lets `write` write the contents.
    fn fill(self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<Filled> {
        let Pending { path, place } = self;
        let filled = match place {
            Place::Stream(file) => buffered(&file, write).map(|()| None),
            Place::File(temporary, place, there) => {
                let file = temporary.file();
                buffered(file, write)
                    .and_then(|()| there.map_or(Ok(()), |there| resemble(file, &there)))
                    // Before it has a name: after a loss of power there is the old file or the new one.
                    .and_then(|()| file.sync_all())
                    .map(|()| Some((temporary, place)))
            }
        };
        match filled {
            Ok(file) => Ok(Filled { path, file }),
            Err(source) => Err(Error::Write { path, source }),
        }
    }
}

/// What a file holds: writes it.
pub type Contents<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

/// Writes files, and puts them in their places when all are complete: a failure leaves none of them.
pub fn write<'a>(files: impl IntoIterator<Item = (Pending, &'a Contents<'a>)>) -> Result<()> {
    let filled = files
        .into_iter()
        .map(|(file, contents)| file.fill(contents));
    place(filled.collect::<Result<Vec<_>>>()?)
}

/// Puts files in their places, all of them before a signal ends the process.
fn place(filled: impl IntoIterator<Item = Filled>) -> Result<()> {
    let mut folders = Vec::new();
    let mut filled: Vec<Filled> = filled.into_iter().collect();
    filled.reverse();
    // Made after the files, so that it is let go before those that a failure leaves: they want it when they go.
    let mut still = still();
    while let Some(Filled { path, file }) = filled.pop() {
        let Some((temporary, place)) = file else {
            continue;
        };
        let placed = temporary.place(&place, &mut still);
        placed.map_err(|source| Error::Write { path, source })?;
        folders.push(target::folder(&place).to_path_buf());
    }
    drop(still);
    folders.dedup();
    for folder in folders {
        // The names as well. Some systems do not open folders, and the files are there all the same.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
    Ok(())
}

/// Why a file could not be made: the user's choice of a name, or a disk that is full already.
fn not_made(path: &Path, source: io::Error) -> Error {
    let path = path.into();
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Error::Write { path, source },
        _ => Error::File { path, source },
    }
}

fn buffered(file: &File, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut buffer = BufWriter::new(file);
    write(&mut buffer)?;
    buffer.flush()
}

/// Mode, and if we may owner and group, of what is there.
#[cfg(unix)]
fn resemble(file: &File, there: &Metadata) -> io::Result<()> {
    use std::fs::Permissions;
    use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
    let own = file.metadata()?;
    if (own.uid(), own.gid()) != (there.uid(), there.gid()) {
        // Only root may give files away. Where a group is not ours we cannot keep it.
        let _ = fchown(file, Some(there.uid()), Some(there.gid()));
    }
    // Without set-user-id and its like, which a write takes away too (write(2)).
    file.set_permissions(Permissions::from_mode(there.mode() & 0o777))
}

#[cfg(not(unix))]
fn resemble(_: &File, _: &Metadata) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::names;
    use std::fs;

    fn pending(path: &Path) -> Pending {
        let made = create(&[], &[("--output", path)]).expect("writable");
        made.into_iter().next().expect("one was asked for")
    }

    fn write(path: &Path, words: &str) {
        let filled = pending(path).fill(|out| out.write_all(words.as_bytes()));
        place([filled.expect("written")]).expect("placed");
    }

    fn read(path: &Path) -> String {
        fs::read_to_string(path).expect("readable")
    }

    #[test]
    fn a_file_appears_complete() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.txt");
        fs::write(&path, "old").expect("written");
        let made = pending(&path);
        assert_eq!(read(&path), "old");
        let filled = made.fill(|out| out.write_all(b"new")).expect("written");
        assert_eq!(read(&path), "old");
        place([filled]).expect("placed");
        assert_eq!(read(&path), "new");
        assert_eq!(names(folder.path()), ["out.txt"]);
    }

    #[test]
    fn a_failure_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.txt");
        let failed = pending(&path).fill(|file| {
            file.write_all(b"half")?;
            Err(io::Error::other("disk full"))
        });
        let error = failed.err().expect("it failed");
        assert_eq!(error.exit_code(), 1);
        let words = error.to_string();
        assert!(words.ends_with("out.txt: disk full"), "{words}");
        drop(pending(&path));
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_missing_folder_is_known_at_once() {
        let path = Path::new("/no/such/folder/out.txt");
        let error = create(&[], &[("--output", path)]).err();
        let error = error.expect("there is no such folder");
        assert_eq!(error.exit_code(), 2);
        let words = error.to_string();
        assert!(words.starts_with("/no/such/folder/out.txt: "), "{words}");
    }

    #[test]
    fn two_outputs_have_two_names() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        fs::create_dir(folder.join("sub")).expect("made");
        let (one, same) = (folder.join("out.txt"), folder.join("sub/../out.txt"));
        for there in [false, true] {
            if there {
                fs::write(&one, "old").expect("written");
            }
            let error = create(&[], &[("--output", &one), ("--stats", &same)]).err();
            let words = error.expect("they are one file").to_string();
            assert!(words.contains("is what --output writes"), "{words}");
        }
        assert_eq!(names(folder), ["out.txt", "sub"]);
    }

    #[cfg(unix)]
    mod unix {
        use super::*;
        use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};

        #[test]
        fn devices_and_links_stay_what_they_are() {
            let null = Path::new("/dev/null");
            write(null, "x");
            let kind = fs::metadata(null).expect("there").file_type();
            assert!(kind.is_char_device());

            let folder = tempfile::tempdir().expect("a folder");
            let (target, link) = (folder.path().join("target"), folder.path().join("link"));
            let second = folder.path().join("second");
            symlink("target", &link).expect("linked");
            symlink(&link, &second).expect("linked");
            // At first it dangles.
            for words in ["one", "two"] {
                write(&second, words);
                assert_eq!(read(&target), words);
                assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
                assert!(fs::symlink_metadata(&second).expect("there").is_symlink());
            }
            assert_eq!(names(folder.path()), ["link", "second", "target"]);
        }

        #[test]
        fn links_without_an_end_are_refused() {
            let folder = tempfile::tempdir().expect("a folder");
            let (one, two) = (folder.path().join("one"), folder.path().join("two"));
            symlink(&two, &one).expect("linked");
            symlink(&one, &two).expect("linked");
            let error = create(&[], &[("--output", &one)]).err();
            assert_eq!(error.expect("a circle").exit_code(), 2);
        }

        #[test]
        fn what_is_read_is_not_written() {
            let folder = tempfile::tempdir().expect("a folder");
            let model = folder.path().join("model.obj");
            fs::write(&model, "v").expect("written");
            let (soft, hard) = (folder.path().join("soft"), folder.path().join("hard"));
            symlink(&model, &soft).expect("linked");
            fs::hard_link(&model, &hard).expect("linked");
            for path in [&model, &soft, &hard] {
                let error = create(&[&model], &[("--output", path)]).err();
                let error = error.expect("it is the same file");
                assert_eq!(error.exit_code(), 2);
                assert!(error.to_string().contains("is what is read"), "{error}");
            }
            assert_eq!(read(&model), "v");
        }

        #[test]
        fn a_file_keeps_its_mode_and_its_other_names_their_contents() {
            let folder = tempfile::tempdir().expect("a folder");
            let (path, other) = (folder.path().join("out"), folder.path().join("other"));
            fs::write(&path, "old").expect("written");
            fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("ours");
            fs::hard_link(&path, &other).expect("linked");
            write(&path, "new");
            let mode = fs::metadata(&path).expect("there").permissions().mode();
            assert_eq!(mode & 0o7777, 0o640);
            assert_eq!((read(&path), read(&other)), ("new".into(), "old".into()));
        }

        /// As much as a file that was made without us.
        #[test]
        fn a_new_file_has_the_mode_of_any_other() {
            let folder = tempfile::tempdir().expect("a folder");
            let (ours, other) = (folder.path().join("ours"), folder.path().join("other"));
            write(&ours, "x");
            fs::write(&other, "x").expect("written");
            let mode = |path| fs::metadata(path).expect("there").permissions().mode();
            assert_eq!(mode(&ours), mode(&other));
        }

        #[test]
        fn a_full_disk_is_no_bad_input() {
            let full = Path::new("/dev/full");
            if !full.exists() {
                println!("skipped: no /dev/full here");
                return;
            }
            let failed = pending(full).fill(|out| out.write_all(b"x")).err();
            assert_eq!(failed.expect("it is full").exit_code(), 1);
        }
    }
}
