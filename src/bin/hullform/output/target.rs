//! What the name of an output leads to.

use std::fs::{self, File, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// Links in a row that Linux follows (path_resolution(7)).
const MAX_LINKS: usize = 40;

/// Where an output goes.
pub enum Target {
    /// A regular file, there or not yet, by its folder's true name and its own behind all links; and what it is like, if it is there.
    File(PathBuf, Option<Box<Metadata>>),
    /// Something else, open: a device, a pipe, a descriptor of this process. To rename a file there would replace it, so it is written to.
    Stream(File),
}

impl Target {
    /// Follows a name. Links stay: what they lead to is meant, even if it is not there yet.
    pub fn of(path: &Path) -> io::Result<Target> {
        let mut path = PathBuf::from(path);
        for _ in 0..MAX_LINKS {
            let folder = fs::canonicalize(folder(&path))?;
            if let Some(stream) = descriptor(&folder, &path)? {
                return Ok(Target::Stream(stream));
            }
            match fs::read_link(&path) {
                Ok(to) => path = folder.join(to),
                Err(_) => return end(&folder, &path),
            }
        }
        // The system's own words for too many links.
        fs::metadata(&path)?;
        Err(io::Error::other("too many links"))
    }

    /// What tells it from all other regular files.
    pub fn identity(&self) -> Option<Identity> {
        match self {
            Target::File(path, None) => Some(Identity::Name(path.clone())),
            Target::File(path, Some(there)) => Some(Identity::new(path, there)),
            Target::Stream(_) => None,
        }
    }
}

/// A name that is no link.
fn end(folder: &Path, path: &Path) -> io::Result<Target> {
    let name = path.file_name().ok_or(io::ErrorKind::IsADirectory)?;
    let path = folder.join(name);
    let there = match fs::metadata(&path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        there => Some(there?),
    };
    if there.is_none() {
        return Ok(Target::File(path, None));
    }
    // Opened whatever it is: a file that may not be written to is not replaced either, and of a folder the system says that it is one.
    let open = File::options().write(true).open(&path)?;
    match there {
        Some(there) if !there.is_file() => Ok(Target::Stream(open)),
        there => Ok(Target::File(path, there.map(Box::new))),
    }
}

/// A descriptor of a process, such as `/dev/stdout` leads to: what is behind it need not have a name, and its position counts.
fn descriptor(folder: &Path, path: &Path) -> io::Result<Option<File>> {
    if !folder.starts_with("/proc") {
        return Ok(None);
    }
    let own = format!("/proc/{}/fd", std::process::id());
    let number = path.file_name().and_then(|name| name.to_str());
    let standard = match number {
        Some("1") if folder == Path::new(&own) => stdout(),
        Some("2") if folder == Path::new(&own) => stderr(),
        _ => None,
    };
    match standard {
        Some(file) => Ok(Some(file)),
        None => File::options().write(true).open(path).map(Some),
    }
}

/// Standard output, as a file.
#[cfg(unix)]
pub fn stdout() -> Option<File> {
    use std::os::fd::AsFd;
    let own = io::stdout().as_fd().try_clone_to_owned();
    own.ok().map(File::from)
}

/// Standard error, as a file.
#[cfg(unix)]
fn stderr() -> Option<File> {
    use std::os::fd::AsFd;
    let own = io::stderr().as_fd().try_clone_to_owned();
    own.ok().map(File::from)
}

#[cfg(not(unix))]
pub fn stdout() -> Option<File> {
    None
}

#[cfg(not(unix))]
fn stderr() -> Option<File> {
    None
}

/// The folder that a name is in.
pub fn folder(path: &Path) -> &Path {
    let folder = path.parent();
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
    // A root has none.
    folder.unwrap_or(if path.has_root() {
        path
    } else {
        Path::new(".")
    })
}

/// What tells one regular file from another, by whatever name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Identity {
    /// Device and inode: the same through links of both kinds.
    #[cfg(unix)]
    Number(u64, u64),
    /// A name in a folder's true name: all there is of a file that is not there yet.
    Name(PathBuf),
}

impl Identity {
    /// Of a file that is there.
    #[cfg(unix)]
    pub fn new(_: &Path, there: &Metadata) -> Identity {
        use std::os::unix::fs::MetadataExt;
        Identity::Number(there.dev(), there.ino())
    }

    /// Of a file that is there.
    #[cfg(not(unix))]
    pub fn new(path: &Path, _: &Metadata) -> Identity {
        Identity::Name(fs::canonicalize(path).unwrap_or_else(|_| path.into()))
    }

    /// Of what a name leads to; None for what is not there or no regular file.
    pub fn of(path: &Path) -> Option<Identity> {
        let there = fs::metadata(path).ok().filter(Metadata::is_file)?;
        Some(Identity::new(path, &there))
    }

    /// Of an open file.
    pub fn of_open(file: &File) -> Option<Identity> {
        let there = file.metadata().ok().filter(Metadata::is_file)?;
        cfg!(unix).then(|| Identity::new(Path::new(""), &there))
    }
}
