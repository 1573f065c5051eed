//! Outputs of a module that nobody reads, taken out of it when a pipeline is made.
//!
//! Drivers that link stages drop them by themselves; llvmpipe does not, and stores each of them for each vertex. A module of its own for every choice of
//! outputs would double those that ship; a specialization constant reaches no interface. So their variables become the invocation's own: what is stored
//! there is read by nobody, and compilers drop the stores (SPIR-V, "Storage Class", Private).

use std::borrow::Cow;
use std::collections::HashMap;

use super::instructions::{DECORATE, HEADER, instructions};

/// Which word of the header is the bound of all numbers.
const BOUND: usize = 3;

const TYPE_POINTER: u32 = 32;
const VARIABLE: u32 = 59;
const ACCESS_CHAIN: u32 = 65;
const IN_BOUNDS_ACCESS_CHAIN: u32 = 66;

const LOCATION: u32 = 30;

const OUTPUT: u32 = 3;
const PRIVATE: u32 = 6;

/// The module with no outputs at locations that are not read. One of which parts have pointers of their own, which ours have not, keeps its output.
///
/// The entry point goes on naming the variables: from SPIR-V 1.4 on, as ours are, it names those of all storage classes.
pub(in crate::gpu) fn with_outputs(words: &[u32], is_read: impl Fn(u32) -> bool) -> Cow<'_, [u32]> {
    let mut located = HashMap::new();
    let mut pointees = HashMap::new();
    let mut outputs = HashMap::new();
    for instruction in instructions(words) {
        match (instruction[0] & 0xffff, instruction) {
            (DECORATE, &[_, target, LOCATION, location]) => {
                located.insert(target, location);
            }
            (TYPE_POINTER, &[_, pointer, _, pointee]) => {
                pointees.insert(pointer, pointee);
            }
            (VARIABLE, &[_, pointer, variable, OUTPUT]) => {
                let location = located.get(&variable);
                let unread = location.is_some_and(|&location| !is_read(location));
                if let Some(&pointee) = pointees.get(&pointer).filter(|_| unread) {
                    outputs.insert(variable, pointee);
                }
            }
            (ACCESS_CHAIN | IN_BOUNDS_ACCESS_CHAIN, &[_, _, _, base, ..]) => {
                outputs.remove(&base);
            }
            _ => {}
        }
    }
    if outputs.is_empty() {
        return Cow::Borrowed(words);
    }
    let mut kept = words[..HEADER].to_vec();
    for instruction in instructions(words) {
        match (instruction[0] & 0xffff, instruction) {
            (DECORATE, &[_, target, ..]) if outputs.contains_key(&target) => {}
            (VARIABLE, &[first, _, variable, _]) if outputs.contains_key(&variable) => {
                // Pointers alone may be declared twice (SPIR-V, "Types and Variables").
                let pointer = kept[BOUND];
                kept[BOUND] += 1;
                kept.extend([4 << 16 | TYPE_POINTER, pointer, PRIVATE, outputs[&variable]]);
                kept.extend([first, pointer, variable, PRIVATE]);
            }
            _ => kept.extend(instruction),
        }
    }
    Cow::Owned(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::shaders::{MODULES, spirv};

    /// Locations of a module's outputs, in order.
    fn outputs(words: &[u32]) -> Vec<u32> {
        let location = |variable| {
            instructions(words).find_map(|instruction| match *instruction {
                [first, target, LOCATION, location]
                    if first & 0xffff == DECORATE && target == variable =>
                {
                    Some(location)
                }
                _ => None,
            })
        };
        let all = instructions(words).filter_map(|instruction| match *instruction {
            [first, _, variable, OUTPUT] if first & 0xffff == VARIABLE => location(variable),
            _ => None,
        });
        let mut all: Vec<u32> = all.collect();
        all.sort();
        all
    }

    #[test]
    fn outputs_that_nobody_reads_are_none() {
        let evaluating = [".tese", ".pattern.vert", ".geom"];
        let ours = MODULES.iter().filter(|(name, _)| {
            !name.starts_with("conformance.") && evaluating.iter().any(|end| name.ends_with(end))
        });
        let mut with_tangents = 0;
        for (name, _) in ours {
            let words = spirv(name).expect("it is listed");
            let all = outputs(words);
            with_tangents += usize::from(all == [0, 1, 2, 3, 4, 5, 6]);
            assert!(with_outputs(words, |_| true) == words, "{name}");
            let plain = with_outputs(words, |location| location < 5);
            assert_eq!(outputs(&plain), [0, 1, 2, 3, 4], "{name}");
            assert!(
                outputs(&with_outputs(words, |_| false)).is_empty(),
                "{name}"
            );
            // Taken out in two steps or one.
            assert_eq!(outputs(&with_outputs(&plain, |at| at == 1)), [1], "{name}");
        }
        assert!(with_tangents > 50, "{with_tangents}");
    }
}
