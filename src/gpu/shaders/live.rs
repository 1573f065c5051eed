//! A folder of GLSL that is compiled while a program runs.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use super::Modules;
use super::glsl::{self, Module, Sources};
use crate::error::{Error, Place, Result};

/// The text of a folder like `glsl/` as it was when it was read, whose modules are compiled when they are asked for, each once. The compiler's own text
/// and options are those of the build: what has not been changed has the same bits.
pub struct Glsl {
    sources: Sources,
    modules: BTreeMap<String, Module>,
    compiled: Mutex<BTreeMap<String, Arc<[u32]>>>,
}

impl Glsl {
    /// Reads a folder.
    ///
    /// # Errors
    /// [`Error::Input`] with the folder when it cannot be read, or has not what modules are made of.
    pub fn read(folder: &Path) -> Result<Glsl> {
        let wrong = |problem: String| {
            let place = Place::File(folder.display().to_string());
            Error::input(
                place,
                problem,
                "name a folder that has all of hullform's shaders",
            )
        };
        let sources = Sources::read(folder).map_err(wrong)?;
        let modules = sources.modules().map_err(wrong)?;
        if modules.is_empty() {
            return Err(wrong("there are no shaders in it".into()));
        }
        let named = modules
            .into_iter()
            .map(|module| (module.name.clone(), module));
        Ok(Glsl {
            modules: named.collect(),
            compiled: Mutex::default(),
            sources,
        })
    }

    fn compile(&self, module: &Module) -> Result<Arc<[u32]>> {
        let made = shaderc::Compiler::new().map_err(|error| error.to_string());
        let made = made.and_then(|compiler| {
            Ok(glsl::compile(&compiler, &self.sources, module)?
                .as_binary()
                .into())
        });
        made.map_err(|words| refused(&module.name, &words))
    }
}

impl Modules for Glsl {
    fn module(&self, name: &str) -> Result<Cow<'_, [u32]>> {
        let module = self.modules.get(name).ok_or_else(|| super::missing(name))?;
        let mut compiled = self.compiled.lock().unwrap_or_else(PoisonError::into_inner);
        let words = match compiled.get(name) {
            Some(words) => words.clone(),
            None => {
                let words = self.compile(module)?;
                compiled.insert(name.into(), words.clone());
                words
            }
        };
        Ok(Cow::Owned(words.to_vec()))
    }

    fn fingerprint(&self, name: &str) -> Option<u64> {
        self.sources.fingerprint(self.modules.get(name)?).ok()
    }
}

/// What the compiler said of a module, by the first line of text that it blames: `FILE:LINE: error: ...`.
fn refused(module: &str, words: &str) -> Error {
    let blamed = words.lines().filter_map(blamed);
    let blamed: Vec<(String, usize, &str)> = blamed.collect();
    let remedy = match blamed.len() {
        0 | 1 => "mend it".to_string(),
        count => format!("mend it, and {} more", count - 1),
    };
    match blamed.into_iter().next() {
        Some((file, line, problem)) => {
            let problem = format!("{problem} (in the module {module})");
            Error::input(Place::Line(file, line), problem, remedy)
        }
        None => Error::input(Place::File(format!("glsl ({module})")), words, remedy),
    }
}

fn blamed(line: &str) -> Option<(String, usize, &str)> {
    let (place, problem) = line.split_once(": error: ")?;
    let place = &place[place.find("glsl/")?..];
    let (file, number) = place.rsplit_once(':')?;
    Some((file.into(), number.parse().ok()?, problem))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::shaders::{Embedded, MODULES};

    fn ours() -> &'static Path {
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/glsl"))
    }

    /// A copy of our shaders.
    fn copy() -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        for (file, text) in crate::gpu::shaders::SOURCES {
            let path = folder.path().join(file);
            let parent = path.parent().expect("it lies in a folder");
            std::fs::create_dir_all(parent).expect("it is made");
            std::fs::write(path, text).expect("it is written");
        }
        folder
    }

    #[test]
    fn what_has_not_been_changed_has_the_same_bits() {
        let glsl = Glsl::read(ours()).expect("the folder is there");
        for (name, _) in MODULES {
            assert_eq!(glsl.fingerprint(name), Embedded.fingerprint(name), "{name}");
        }
        let name = "coloured.frag";
        assert_eq!(glsl.module(name).ok(), Embedded.module(name).ok());
    }

    #[test]
    fn errors_name_file_and_line_also_of_what_is_included() {
        let folder = copy();
        let path = folder.path().join("lib/unit.glsl");
        let text = std::fs::read_to_string(&path).expect("it is there");
        std::fs::write(&path, format!("{text}\nnonsense here;\n")).expect("it is written");
        let line = text.lines().count() + 2;
        let glsl = Glsl::read(folder.path()).expect("text of any kind is read");
        let method = crate::method::METHODS.last().expect("there are methods");
        let name = &format!("{}.equal.tese", method.name);
        assert_ne!(glsl.fingerprint(name), Embedded.fingerprint(name));
        let words = glsl.module(name).expect_err("it is nonsense").to_string();
        assert!(
            words.starts_with(&format!("glsl/lib/unit.glsl:{line}: ")),
            "{words}"
        );
        std::fs::write(&path, text).expect("it is written");
        let glsl = Glsl::read(folder.path()).expect("it is there");
        assert_eq!(glsl.module(name).ok(), Embedded.module(name).ok());
    }
}
