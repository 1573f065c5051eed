//! What flows into the outputs of a SPIR-V module, and which of it a driver may contract.

use std::collections::{BTreeMap, BTreeSet};

use super::spirv::instructions;

const EXTENDED: u32 = 12;
const FUNCTION: u32 = 54;
const CALL: u32 = 57;
const VARIABLE: u32 = 59;
const LOAD: u32 = 61;
const STORE: u32 = 62;
const ACCESS_CHAINS: [u32; 2] = [65, 66];
const DECORATE: u32 = 71;
const MEMBER_DECORATE: u32 = 72;
const VECTOR_SHUFFLE: u32 = 79;
const COMPOSITE_EXTRACT: u32 = 81;
const COMPOSITE_INSERT: u32 = 82;
const LABEL: u32 = 248;
const BRANCH_CONDITIONAL: u32 = 250;
const SWITCH: u32 = 251;
/// Instructions of functions that have no result.
const WITHOUT_RESULT: [u32; 16] = [
    0, 8, 56, 218, 219, 224, 225, 228, 246, 247, 249, 252, 253, 254, 255, 317,
];

/// Additions, multiplications and divisions of floats, and what is made of them: OpFAdd, FSub, FMul, FDiv, FRem, FMod, all products of
/// vectors and matrices. OpFNegate is exact.
const ARITHMETIC: [u32; 13] = [
    129, 131, 133, 136, 140, 141, 142, 143, 144, 145, 146, 147, 148,
];

/// Extended instructions that round once or not at all, by a rule of the device that no neighbour changes: RoundEven, FAbs, Floor, Ceil, InverseSqrt,
/// minima, maxima, clamps. Mixes, fused multiplications, lengths and cross products are not among them.
const ONE_ROUNDING: [u32; 13] = [2, 4, 8, 9, 32, 37, 38, 39, 40, 41, 42, 43, 44];

const NO_CONTRACTION: u32 = 42;

/// Where an output is: the decoration of a variable, of a block's member, or of a buffer, and its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    Location(u32),
    BuiltIn(u32),
    Binding(u32),
}

impl Output {
    fn decoration(self) -> [u32; 2] {
        match self {
            Output::BuiltIn(number) => [11, number],
            Output::Location(number) => [30, number],
            Output::Binding(number) => [33, number],
        }
    }
}

/// A module's instructions, by what they define.
pub struct Flow {
    definitions: BTreeMap<u32, Vec<u32>>,
    /// Of each variable: the values that are stored there, and the indices.
    stores: BTreeMap<u32, Vec<u32>>,
    conditions: Vec<u32>,
    decorations: BTreeMap<u32, Vec<Vec<u32>>>,
    outputs: BTreeSet<u32>,
}

fn operation(instruction: &[u32]) -> u32 {
    instruction[0] & 0xffff
}

impl Flow {
    pub fn of(bytes: &[u8]) -> Flow {
        let mut flow = Flow {
            definitions: BTreeMap::new(),
            stores: BTreeMap::new(),
            conditions: Vec::new(),
            decorations: BTreeMap::new(),
            outputs: BTreeSet::new(),
        };
        let mut stores = Vec::new();
        let mut inside = false;
        for instruction in instructions(bytes) {
            let operands = &instruction[1..];
            match operation(&instruction) {
                DECORATE => flow.decorate(operands[0], &operands[1..]),
                MEMBER_DECORATE => flow.decorate(operands[0], &operands[2..]),
                VARIABLE => {
                    const INPUT: u32 = 1;
                    if operands[2] != INPUT {
                        flow.outputs.insert(operands[1]);
                    }
                    flow.definitions.insert(operands[1], instruction);
                }
                FUNCTION => inside = true,
                CALL => panic!("a module is one function: everything is inlined"),
                STORE => stores.push((operands[0], operands[1])),
                BRANCH_CONDITIONAL | SWITCH => flow.conditions.push(operands[0]),
                LABEL => {}
                other if WITHOUT_RESULT.contains(&other) => {}
                _ if inside => {
                    flow.definitions.insert(operands[1], instruction);
                }
                _ => {}
            }
        }
        for (pointer, value) in stores {
            let (variable, mut values) = flow.root(pointer);
            values.push(value);
            flow.stores.entry(variable).or_default().extend(values);
        }
        flow
    }

    fn decorate(&mut self, target: u32, decoration: &[u32]) {
        let decorations = self.decorations.entry(target).or_default();
        decorations.push(decoration.to_vec());
    }

    /// The variable that a pointer points into, and the indices on the way.
    fn root(&self, mut pointer: u32) -> (u32, Vec<u32>) {
        let mut indices = Vec::new();
        while let Some(instruction) = self.definitions.get(&pointer) {
            if !ACCESS_CHAINS.contains(&operation(instruction)) {
                break;
            }
            indices.extend(&instruction[4..]);
            pointer = instruction[3];
        }
        (pointer, indices)
    }

    /// What an instruction makes its result of.
    fn sources(&self, instruction: &[u32]) -> Vec<u32> {
        let operands = &instruction[3..];
        match operation(instruction) {
            EXTENDED => operands[2..].to_vec(),
            COMPOSITE_EXTRACT => operands[..1].to_vec(),
            COMPOSITE_INSERT | VECTOR_SHUFFLE => operands[..2].to_vec(),
            LOAD => {
                let (variable, mut sources) = self.root(operands[0]);
                sources.extend(self.stores.get(&variable).into_iter().flatten());
                sources
            }
            _ => operands.to_vec(),
        }
    }

    /// Everything that has a say in what is stored to an output, or in which way the module goes.
    fn into(&self, outputs: &[Output]) -> BTreeSet<u32> {
        let is_one = |target: u32| {
            let own = self.decorations.get(&target).into_iter().flatten();
            own.into_iter().any(|own| {
                outputs
                    .iter()
                    .any(|output| output.decoration()[..] == own[..])
            })
        };
        let stored = self
            .stores
            .iter()
            .filter(|(variable, _)| self.outputs.contains(variable) && is_one(**variable));
        let mut open: Vec<u32> = stored.flat_map(|(_, values)| values.clone()).collect();
        assert!(!open.is_empty(), "nothing is stored to {outputs:?}");
        open.extend(&self.conditions);
        let mut found = BTreeSet::new();
        while let Some(id) = open.pop() {
            let Some(instruction) = self.definitions.get(&id) else {
                continue;
            };
            if found.insert(id) && operation(instruction) != VARIABLE {
                open.extend(self.sources(instruction));
            }
        }
        found
    }

    /// Of the arithmetic that flows into outputs: how much there is, and what a driver may contract of it, as instructions.
    pub fn contractible(&self, outputs: &[Output]) -> (usize, Vec<String>) {
        let mut count = 0;
        let mut free = Vec::new();
        for id in self.into(outputs) {
            let instruction = &self.definitions[&id];
            let exact = match operation(instruction) {
                EXTENDED => ONE_ROUNDING.contains(&instruction[4]),
                operation if ARITHMETIC.contains(&operation) => {
                    let own = self.decorations.get(&id).into_iter().flatten();
                    own.into_iter().any(|own| own[..] == [NO_CONTRACTION])
                }
                _ => continue,
            };
            count += 1;
            if !exact {
                free.push(format!("%{id}: operation {}", operation(instruction)));
            }
        }
        (count, free)
    }
}
