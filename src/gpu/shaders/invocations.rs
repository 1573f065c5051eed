//! How many invocations a control shader has that shares its work among them: as many as the device runs abreast.
//!
//! GLSL takes no specialization constant for `layout(vertices = ...) out` (GLSL 4.60, section 4.4.2). So the constant by which the shader shares its work comes
//! from the pipeline, and the module's execution mode is set to the same number (SPIR-V, "Execution Mode", OutputVertices). Such a shader has no outputs of
//! single vertices, whose arrays would have that length too.

use std::borrow::Cow;

use crate::abi;

use super::instructions::{DECORATE, instructions};

const EXECUTION_MODE: u32 = 16;

const SPEC_ID: u32 = 1;
const OUTPUT_VERTICES: u32 = 26;

/// The module with so many invocations, if it has the constant.
pub(in crate::gpu) fn with_invocations(words: &[u32], invocations: u32) -> Cow<'_, [u32]> {
    let shares = instructions(words).any(|instruction| {
        matches!(*instruction, [first, _, SPEC_ID, abi::CONSTANT_ID_INVOCATIONS] if first & 0xffff == DECORATE)
    });
    if !shares {
        return Cow::Borrowed(words);
    }
    let mut kept = words.to_vec();
    let mut at = words.len() - instructions(words).map(<[u32]>::len).sum::<usize>();
    for instruction in instructions(words) {
        if matches!(*instruction, [first, _, OUTPUT_VERTICES, _] if first & 0xffff == EXECUTION_MODE)
        {
            kept[at + 3] = invocations;
        }
        at += instruction.len();
    }
    Cow::Owned(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::shaders::{MODULES, spirv};

    #[test]
    fn control_shaders_that_fill_the_ring_have_as_many_invocations_as_they_are_told() {
        let mut sharing = Vec::new();
        for (name, _) in MODULES {
            let words = spirv(name).expect("it is listed");
            let told = with_invocations(words, 8);
            let changed = words.iter().zip(&*told).filter(|(own, told)| own != told);
            let changed: Vec<_> = changed.collect();
            if !changed.is_empty() {
                assert_eq!(changed, [(&abi::CONTROL_INVOCATIONS, &8)], "{name}");
                sharing.push(*name);
            }
        }
        assert_eq!(sharing.len(), 3, "{sharing:?}");
        let control = |name: &&str| name.ends_with(".tesc");
        assert!(sharing.iter().all(control), "{sharing:?}");
    }
}
