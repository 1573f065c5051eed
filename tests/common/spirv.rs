//! A small reader of SPIR-V.

/// The instructions of a module, each as its words.
pub fn instructions(bytes: &[u8]) -> Vec<Vec<u32>> {
    let words: Vec<u32> = bytes
        .chunks_exact(4)
        .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
        .collect();
    assert_eq!(words[0], 0x0723_0203, "SPIR-V starts with its magic number");
    let mut rest = &words[5..];
    let mut instructions = Vec::new();
    while let Some(first) = rest.first() {
        let (instruction, others) = rest.split_at((first >> 16) as usize);
        instructions.push(instruction.to_vec());
        rest = others;
    }
    instructions
}
