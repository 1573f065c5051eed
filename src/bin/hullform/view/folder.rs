//! Files beside a file.

use std::path::{Path, PathBuf};

/// The OBJ file that comes after another in its folder, or before it, around; None where there is no other.
pub fn neighbour(file: &Path, ahead: bool) -> Option<PathBuf> {
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).ok()?;
    let paths = entries.filter_map(|entry| entry.ok().map(|entry| entry.path()));
    let is_obj = |path: &PathBuf| {
        let extension = path.extension().unwrap_or_default();
        extension.eq_ignore_ascii_case("obj") && path.is_file()
    };
    let mut all: Vec<PathBuf> = paths.filter(is_obj).collect();
    all.sort();
    let name = file.file_name();
    let others = all.iter().any(|path| path.file_name() != name);
    let at = all.iter().position(|path| path.file_name() == name);
    let count = all.len();
    let next = match (at, ahead) {
        _ if !others => return None,
        (Some(at), true) => (at + 1) % count,
        (Some(at), false) => (at + count - 1) % count,
        (None, _) => 0,
    };
    Some(all.swap_remove(next))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_follow_one_another_around_the_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["b.obj", "a.OBJ", "c.txt", "c.obj"] {
            std::fs::write(folder.path().join(name), "").expect("it is written");
        }
        let after = |name: &str, ahead| {
            let next = neighbour(&folder.path().join(name), ahead)?;
            Some(next.file_name()?.to_string_lossy().into_owned())
        };
        assert_eq!(after("a.OBJ", true).as_deref(), Some("b.obj"));
        assert_eq!(after("a.OBJ", false).as_deref(), Some("c.obj"));
        assert_eq!(after("c.obj", true).as_deref(), Some("a.OBJ"));
        assert_eq!(neighbour(Path::new("/nowhere/a.obj"), true), None);
    }
}
