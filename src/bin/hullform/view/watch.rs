//! Files that are watched: when one changes, its model is read again.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use notify::{RecommendedWatcher, RecursiveMode, Watcher};

use super::workers::Wake;

/// What watches files. Folders are watched, since editors put a new file into the place of the old one.
pub struct Watch {
    watcher: Option<RecommendedWatcher>,
    changed: Receiver<PathBuf>,
    /// What is told of; other files in their folders may change as they like.
    files: Arc<Mutex<BTreeSet<PathBuf>>>,
    folders: BTreeSet<PathBuf>,
    /// Folders of which everything is told.
    whole: Arc<Mutex<BTreeSet<PathBuf>>>,
}

impl Watch {
    /// Nothing is watched yet. Where the system cannot watch, nothing ever changes.
    pub fn new(wake: Wake) -> Watch {
        let (sender, changed) = channel();
        let files = Arc::<Mutex<BTreeSet<PathBuf>>>::default();
        let whole = Arc::<Mutex<BTreeSet<PathBuf>>>::default();
        let (watched, inside) = (files.clone(), whole.clone());
        let told = move |event: notify::Result<notify::Event>| {
            let Ok(event) = event else { return };
            let written = event.kind.is_modify() || event.kind.is_create();
            let places = event.paths.iter().filter_map(|path| place(path));
            let told = |place: &PathBuf| {
                let within = |folder| place.starts_with(folder);
                written
                    && (files_of(&watched).contains(place) || files_of(&inside).iter().any(within))
            };
            for place in places.filter(told) {
                // Nobody listens any more once the window has gone.
                let _ = sender.send(place);
                wake();
            }
        };
        let watcher = notify::recommended_watcher(told);
        Watch {
            watcher: watcher.ok(),
            changed,
            files,
            folders: BTreeSet::new(),
            whole,
        }
    }

    /// Watches everything in a folder, by its real name.
    pub fn look_into(&mut self, folder: &Path) {
        if let Some(watcher) = &mut self.watcher
            && watcher.watch(folder, RecursiveMode::Recursive).is_ok()
        {
            files_of(&self.whole).insert(folder.into());
        }
    }

    /// Watches the folders of these files as well.
    pub fn look_after<'f>(&mut self, files: impl Iterator<Item = &'f Path>) {
        let Some(watcher) = &mut self.watcher else {
            return;
        };
        for file in files {
            let Some(place) = place(file) else { continue };
            let Some(folder) = place.parent().map(Path::to_path_buf) else {
                continue;
            };
            files_of(&self.files).insert(place);
            if !self.folders.contains(&folder)
                && watcher.watch(&folder, RecursiveMode::NonRecursive).is_ok()
            {
                self.folders.insert(folder);
            }
        }
    }

    /// The files that have changed since this was asked last.
    pub fn changed(&self) -> BTreeSet<PathBuf> {
        self.changed.try_iter().collect()
    }
}

fn files_of(files: &Mutex<BTreeSet<PathBuf>>) -> MutexGuard<'_, BTreeSet<PathBuf>> {
    files.lock().unwrap_or_else(PoisonError::into_inner)
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
        let inside = folder.path().join("lib");
        std::fs::create_dir(&inside).expect("it is made");
        watch.look_into(&folder.path().canonicalize().expect("it is there"));
        let file = inside.join("a.glsl");
        std::fs::write(&file, "4").expect("it is written");
        let started = Instant::now();
        while !watch.changed().contains(&place(&file).expect("a place")) {
            assert!(started.elapsed() < Duration::from_secs(20));
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}
