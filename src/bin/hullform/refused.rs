//! What the library refuses, in the words of the command line.

use hullform::{Error, Misuse};

/// What the library calls the ring.
const RING: &str = "scratch ring";

/// What the library refuses, as the option that a user can change; what no option brings about stays as it is.
pub fn in_words_of_options(error: Error) -> Error {
    let Error::Misuse(misuse) = error else {
        return error;
    };
    let (option, remedy) = match misuse {
        Misuse::RingTooSmall { .. } => (
            "--ring-bytes",
            "give a larger ring, or draw at a lower level",
        ),
        Misuse::BackendWithoutRing { .. } => (
            "--backend",
            "choose the backend tessellator, --residence cache, or a method without a ring",
        ),
        Misuse::BackendLevel { .. } => (
            "--level",
            "choose a lower level, or the backend pattern or tessellator",
        ),
        Misuse::SubPatchSpacing => ("--spacing", "choose equal, or a level of 64 at most"),
        Misuse::SubPatchesOfTriangles => (
            "--level",
            "choose a level of 64 at most, or a method of quads",
        ),
        Misuse::MacroFaces { .. } => ("--macro", "leave that out, or --macro"),
        Misuse::MacroLevel { .. } => (
            "--level",
            "choose a lower level, a smaller --macro-span, or leave out --macro",
        ),
        Misuse::BufferTooLarge { ref what, .. } if what == RING => {
            ("--ring-bytes", "give a smaller ring")
        }
        other => return Error::Misuse(other),
    };
    Error::Option {
        option,
        problem: misuse.to_string(),
        remedy: remedy.into(),
    }
}
