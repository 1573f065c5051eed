//! The instructions that a module is made of.

/// The words before the first instruction: magic number, version, generator, bound, schema (SPIR-V, "Physical Layout").
pub(super) const HEADER: usize = 5;

/// `OpDecorate`.
pub(super) const DECORATE: u32 = 71;

/// The instructions of a module, each with its first word, which has length and opcode.
pub(super) fn instructions(words: &[u32]) -> impl Iterator<Item = &[u32]> {
    let mut rest = words.get(HEADER..).unwrap_or_default();
    std::iter::from_fn(move || {
        let length = (rest.first()? >> 16).max(1) as usize;
        let (instruction, others) = rest.split_at(length.min(rest.len()));
        rest = others;
        Some(instruction)
    })
}
