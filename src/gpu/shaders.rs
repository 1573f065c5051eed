//! The shaders: SPIR-V modules for the pipelines, and the GLSL they come from for engines that build their own.
//!
//! The lists are written by `build.rs` from the folder `glsl/`. A module is named like its file (`surface.frag`), or
//! like its method and stage (`quadtree.tese`).

#[cfg(feature = "shaderc")]
mod glsl;
mod instructions;
mod invocations;
#[cfg(feature = "shaderc")]
mod live;
mod outputs;

use std::borrow::Cow;

use crate::error::{Error, Result};

pub(super) use invocations::with_invocations;
#[cfg(feature = "shaderc")]
pub use live::Glsl;
pub(super) use outputs::with_outputs;

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// Puts bytes where words may start: `include_bytes!` promises no alignment.
#[repr(C, align(4))]
#[allow(dead_code, reason = "without modules in glsl/ the list is empty")]
struct Aligned<const N: usize>([u8; N]);

/// The words of a module, ready for `VkShaderModuleCreateInfo`.
pub fn spirv(name: &str) -> Option<&'static [u32]> {
    find(MODULES, name).map(bytemuck::cast_slice)
}

/// The text of a GLSL source by its path below `glsl/`, for example `lib/bspline.glsl`.
pub fn source(path: &str) -> Option<&'static str> {
    find(SOURCES, path)
}

/// Where pipelines get their modules from.
pub trait Modules {
    /// The words of a module, ready for `VkShaderModuleCreateInfo`.
    ///
    /// # Errors
    /// [`Error::Refused`] when there is none of this name; that of a compiler, where there is one.
    fn module(&self, name: &str) -> Result<Cow<'_, [u32]>>;

    /// A hash of all that decides what a module becomes; None when there is none of this name.
    fn fingerprint(&self, name: &str) -> Option<u64>;
}

/// The modules that the crate brings.
#[derive(Clone, Copy, Debug, Default)]
pub struct Embedded;

impl Modules for Embedded {
    fn module(&self, name: &str) -> Result<Cow<'_, [u32]>> {
        spirv(name).map(Cow::Borrowed).ok_or_else(|| missing(name))
    }

    fn fingerprint(&self, name: &str) -> Option<u64> {
        find(FINGERPRINTS, name)
    }
}

/// A module whose descriptor sets have numbers from `first` on.
pub(super) fn moved(words: &[u32], first: u32) -> Cow<'_, [u32]> {
    if first == 0 {
        return Cow::Borrowed(words);
    }
    // SPIR-V, "Physical Layout" and OpDecorate: the first word has length and opcode, then come the target, the decoration, and its number.
    const HEADER: usize = 5;
    const DECORATE: u32 = 71;
    const DESCRIPTOR_SET: u32 = 34;
    let mut moved = words.to_vec();
    let mut at = HEADER;
    while at < moved.len() {
        let (length, opcode) = (moved[at] >> 16, moved[at] & 0xffff);
        if opcode == DECORATE && moved[at + 2] == DESCRIPTOR_SET {
            moved[at + 3] += first;
        }
        at += length.max(1) as usize;
    }
    Cow::Owned(moved)
}

fn missing(name: &str) -> Error {
    Error::Refused(format!("there is no shader module {name}"))
}

/// The lists are sorted by name.
fn find<T: Copy>(list: &[(&str, T)], name: &str) -> Option<T> {
    let place = list
        .binary_search_by(|(other, _)| (*other).cmp(name))
        .ok()?;
    Some(list[place].1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_module_is_found_and_is_spirv() {
        for (name, bytes) in MODULES {
            let words = spirv(name).expect("listed modules are found");
            assert_eq!(words.len() * 4, bytes.len(), "{name}");
            assert_eq!(
                words[0], 0x0723_0203,
                "{name} starts with the SPIR-V magic number"
            );
        }
        assert!(spirv("no such module").is_none());
    }

    #[test]
    fn every_source_is_found() {
        for (path, text) in SOURCES {
            assert_eq!(source(path), Some(*text));
        }
        assert!(source("no/such.glsl").is_none());
    }
}
