//! What the window remembers from one time to the next: one file of settings. Nothing else is written unasked.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::viewer::Viewer;
use crate::{output, places};

/// Beyond this no window is made again.
const MOST: u64 = 16384;

/// What is remembered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// The window's size in points.
    pub size: Option<[u32; 2]>,
    /// Files that were opened, the latest first.
    pub recent: Vec<PathBuf>,
    /// Whether panels are there.
    pub panels: Option<bool>,
    /// Whether lines of sight are parallel.
    pub orthographic: Option<bool>,
}

/// The file of settings; None where there is no home.
pub fn file() -> Option<PathBuf> {
    Some(places::settings()?.join("view.json"))
}

impl Settings {
    /// What a file remembers. What it does not say, or nobody understands, is as it is at first.
    pub fn read(file: &Path) -> Settings {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        let value: Value = serde_json::from_str(&text).unwrap_or_default();
        Settings::of(&value)
    }

    fn of(value: &Value) -> Settings {
        let side = |place: usize| {
            let side = value["size"][place].as_u64()?;
            (1..=MOST).contains(&side).then_some(side as u32)
        };
        let recent = value["recent"].as_array().map_or(&[][..], Vec::as_slice);
        let recent = recent
            .iter()
            .filter_map(|path| path.as_str().map(PathBuf::from));
        Settings {
            size: side(0).zip(side(1)).map(|(width, height)| [width, height]),
            recent: recent.take(12).collect(),
            panels: value["panels"].as_bool(),
            orthographic: value["parallel"].as_bool(),
        }
    }

    /// What is to be remembered of a viewer in a window of this size.
    pub fn of_viewer(viewer: &Viewer, size: Option<[u32; 2]>) -> Settings {
        Settings {
            size,
            recent: viewer.recent.clone(),
            panels: Some(viewer.panels),
            orthographic: Some(viewer.orbit.orthographic),
        }
    }

    /// Writes the file.
    pub fn write(&self, file: &Path) -> std::io::Result<()> {
        output::replace(file, format!("{:#}\n", self.value()).as_bytes())
    }

    fn value(&self) -> Value {
        json!({
            "size": self.size,
            "recent": self.recent,
            "panels": self.panels,
            "parallel": self.orthographic,
        })
    }

    /// Sets a viewer up as it was.
    pub fn apply(&self, viewer: &mut Viewer) {
        viewer.recent.clone_from(&self.recent);
        viewer.panels = self.panels.unwrap_or(viewer.panels);
        viewer.orbit.orthographic = self.orthographic.unwrap_or(viewer.orbit.orthographic);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_come_back_and_nonsense_is_as_nothing() {
        let settings = Settings {
            size: Some([800, 600]),
            recent: vec!["a.obj".into(), "/b.obj".into()],
            panels: Some(false),
            orthographic: Some(true),
        };
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("new").join("view.json");
        settings.write(&file).expect("it is written");
        assert_eq!(Settings::read(&file), settings);
        for text in [
            "",
            "[1, 2",
            "{\"size\": [0, 99999999], \"recent\": 3}",
            "null",
        ] {
            std::fs::write(&file, text).expect("it is written");
            assert_eq!(Settings::read(&file), Settings::default(), "{text}");
        }
    }
}
