//! Files that are watched: when one changes, its model is read again.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};

use notify::{RecommendedWatcher, RecursiveMode, Watcher};

use super::workers::Wake;

/// What watches files. Folders are watched, since editors put a new file into the place of the old one.
pub struct Watch {
    watcher: Option<RecommendedWatcher>,
    changed: Receiver<PathBuf>,
    folders: BTreeSet<PathBuf>,
}

impl Watch {
    /// Nothing is watched yet. Where the system cannot watch, nothing ever changes.
    pub fn new(wake: Wake) -> Watch {
        let (sender, changed) = channel();
        let told = move |event: notify::Result<notify::Event>| {
            let Ok(event) = event else { return };
            let written = event.kind.is_modify() || event.kind.is_create();
            for path in event.paths.into_iter().filter(|_| written) {
                // Nobody listens any more once the window has gone.
                let _ = sender.send(path);
            }
            wake();
        };
        let watcher = notify::recommended_watcher(told);
        Watch {
            watcher: watcher.ok(),
            changed,
            folders: BTreeSet::new(),
        }
    }

    /// Watches the folders of these files as well.
    pub fn look_after<'f>(&mut self, files: impl Iterator<Item = &'f Path>) {
        let Some(watcher) = &mut self.watcher else {
            return;
        };
        for file in files {
            let Some(folder) = place(file).and_then(|file| Some(file.parent()?.to_path_buf()))
            else {
                continue;
            };
            if !self.folders.contains(&folder)
                && watcher.watch(&folder, RecursiveMode::NonRecursive).is_ok()
            {
                self.folders.insert(folder);
            }
        }
    }

    /// The files that have changed since this was asked last.
    pub fn changed(&self) -> BTreeSet<PathBuf> {
        let changed = self.changed.try_iter();
        changed.filter_map(|path| place(&path)).collect()
    }
}

/// Where a file is, by the real name of its folder: the file itself may be away for a moment.
pub fn place(file: &Path) -> Option<PathBuf> {
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    Some(folder.canonicalize().ok()?.join(file.file_name()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::time::{Duration, Instant};

    #[test]
    fn a_file_that_is_written_or_replaced_is_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.obj");
        std::fs::write(&file, "1").expect("it is written");
        let mut watch = Watch::new(Arc::new(|| {}));
        watch.look_after([file.as_path()].into_iter());
        let told = || {
            let started = Instant::now();
            while started.elapsed() < Duration::from_secs(20) {
                if watch.changed().contains(&place(&file).expect("a place")) {
                    return true;
                }
                std::thread::sleep(Duration::from_millis(10));
            }
            false
        };
        std::fs::write(&file, "2").expect("it is written");
        assert!(told());
        let other = folder.path().join("b.obj");
        std::fs::write(&other, "3").expect("it is written");
        std::fs::rename(&other, &file).expect("it is replaced");
        assert!(told());
    }
}
