//! Execution modes of tessellation shaders, rewritten in the module.
//!
//! Domain, spacing, order, point mode and the number of control invocations are modes and not constants that one could specialise. Instead of
//! a module for each of their combinations there is one, and this.

use crate::error::{Error, Result};
use crate::gpu::shaders;

/// SPIR-V, section "Execution Mode".
mod mode {
    pub const INVOCATIONS: u32 = 0;
    pub const SPACING_EQUAL: u32 = 1;
    pub const SPACING_FRACTIONAL_EVEN: u32 = 2;
    pub const SPACING_FRACTIONAL_ODD: u32 = 3;
    pub const VERTEX_ORDER_CW: u32 = 4;
    pub const VERTEX_ORDER_CCW: u32 = 5;
    pub const POINT_MODE: u32 = 10;
    pub const TRIANGLES: u32 = 22;
    pub const QUADS: u32 = 24;
    pub const OUTPUT_VERTICES: u32 = 26;
    pub const ISOLINES: u32 = 25;
}

const OP_EXECUTION_MODE: u32 = 16;
/// Words before the first instruction.
const HEADER: usize = 5;

/// What the tessellator cuts up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    Triangles,
    Quads,
    Isolines,
}

/// All three spacings of Vulkan; our surfaces use two of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    Equal,
    FractionalEven,
    FractionalOdd,
}

/// The modes of an evaluation shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modes {
    pub domain: Domain,
    pub spacing: Spacing,
    pub clockwise: bool,
    pub points: bool,
}

impl Domain {
    pub const ALL: [Domain; 3] = [Domain::Triangles, Domain::Quads, Domain::Isolines];

    pub fn name(self) -> &'static str {
        match self {
            Domain::Triangles => "triangles",
            Domain::Quads => "quads",
            Domain::Isolines => "isolines",
        }
    }

    fn mode(self) -> u32 {
        match self {
            Domain::Triangles => mode::TRIANGLES,
            Domain::Quads => mode::QUADS,
            Domain::Isolines => mode::ISOLINES,
        }
    }
}

impl Spacing {
    pub const ALL: [Spacing; 3] = [
        Spacing::Equal,
        Spacing::FractionalEven,
        Spacing::FractionalOdd,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Spacing::Equal => "equal",
            Spacing::FractionalEven => "fractional_even",
            Spacing::FractionalOdd => "fractional_odd",
        }
    }

    fn mode(self) -> u32 {
        match self {
            Spacing::Equal => mode::SPACING_EQUAL,
            Spacing::FractionalEven => mode::SPACING_FRACTIONAL_EVEN,
            Spacing::FractionalOdd => mode::SPACING_FRACTIONAL_ODD,
        }
    }
}

impl Modes {
    /// Counter-clockwise triangles or lines.
    pub fn new(domain: Domain, spacing: Spacing) -> Modes {
        Modes {
            domain,
            spacing,
            clockwise: false,
            points: false,
        }
    }

    /// An evaluation shader with these modes instead of its own.
    pub fn rewrite(self, words: &[u32]) -> Vec<u32> {
        let order = if self.clockwise {
            mode::VERTEX_ORDER_CW
        } else {
            mode::VERTEX_ORDER_CCW
        };
        let replaced = |old: u32| match old {
            mode::SPACING_EQUAL..=mode::SPACING_FRACTIONAL_ODD => self.spacing.mode(),
            mode::VERTEX_ORDER_CW..=mode::VERTEX_ORDER_CCW => order,
            mode::TRIANGLES | mode::QUADS | mode::ISOLINES => self.domain.mode(),
            other => other,
        };
        let mut added = false;
        rewrite(words, |instruction, out| {
            out.extend_from_slice(&[instruction[0], instruction[1], replaced(instruction[2])]);
            out.extend_from_slice(&instruction[3..]);
            if self.points && !added {
                added = true;
                out.extend_from_slice(&[
                    3 << 16 | OP_EXECUTION_MODE,
                    instruction[1],
                    mode::POINT_MODE,
                ]);
            }
        })
    }
}

/// A control shader with so many output vertices, hence invocations, instead of its own.
pub fn with_invocations(words: &[u32], invocations: u32) -> Vec<u32> {
    with_number(words, mode::OUTPUT_VERTICES, invocations)
}

/// A geometry shader with so many invocations instead of its own.
pub fn with_geometry_invocations(words: &[u32], invocations: u32) -> Vec<u32> {
    with_number(words, mode::INVOCATIONS, invocations)
}

/// A module with another number in a mode that it has.
fn with_number(words: &[u32], mode: u32, number: u32) -> Vec<u32> {
    rewrite(words, |instruction, out| {
        let mut instruction = instruction.to_vec();
        if instruction[2] == mode {
            instruction[3] = number;
        }
        out.extend(instruction);
    })
}

/// Copies a module, with every execution mode as `change` writes it.
fn rewrite(words: &[u32], mut change: impl FnMut(&[u32], &mut Vec<u32>)) -> Vec<u32> {
    let (header, mut rest) = words.split_at(HEADER);
    let mut out = header.to_vec();
    while let Some(first) = rest.first() {
        let (instruction, others) = rest.split_at((first >> 16).max(1) as usize);
        if first & 0xffff == OP_EXECUTION_MODE {
            change(instruction, &mut out);
        } else {
            out.extend_from_slice(instruction);
        }
        rest = others;
    }
    out
}

/// The words of a module of the suite.
pub fn module(name: &str) -> Result<&'static [u32]> {
    shaders::spirv(&format!("conformance.{name}")).ok_or_else(|| {
        Error::Refused(format!(
            "the suite's shader {name} is not in this build; build again from complete sources"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modes(words: &[u32]) -> Vec<Vec<u32>> {
        let mut found = Vec::new();
        rewrite(words, |instruction, _| {
            found.push(instruction[2..].to_vec())
        });
        found
    }

    #[test]
    fn every_mode_is_replaced_and_nothing_else() {
        let words = module("coordinates.tese").expect("it ships");
        let same = Modes::new(Domain::Quads, Spacing::Equal);
        assert_eq!(same.rewrite(words), words);
        let other = Modes {
            domain: Domain::Isolines,
            spacing: Spacing::FractionalOdd,
            clockwise: true,
            points: true,
        };
        let changed = other.rewrite(words);
        assert_eq!(changed.len(), words.len() + 3);
        let mut found = modes(&changed);
        found.sort();
        let wanted = [
            mode::SPACING_FRACTIONAL_ODD,
            mode::VERTEX_ORDER_CW,
            mode::POINT_MODE,
            mode::ISOLINES,
        ];
        assert_eq!(found, wanted.map(|mode| vec![mode]));
    }

    #[test]
    fn invocations_are_replaced() {
        let words = module("visibility-coherent.tesc").expect("it ships");
        assert_eq!(with_invocations(words, 32), words);
        let changed = with_invocations(words, 5);
        assert_eq!(modes(&changed), [vec![mode::OUTPUT_VERTICES, 5]]);
    }
}
