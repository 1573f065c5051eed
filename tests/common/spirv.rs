//! A small reader of SPIR-V.

use std::collections::BTreeMap;

const TYPE_ARRAY: u32 = 28;
const TYPE_RUNTIME_ARRAY: u32 = 29;
const TYPE_STRUCT: u32 = 30;
const TYPE_POINTER: u32 = 32;
const VARIABLE: u32 = 59;
const DECORATE: u32 = 71;
const MEMBER_DECORATE: u32 = 72;

const ARRAY_STRIDE: u32 = 6;
const BINDING: u32 = 33;
const OFFSET: u32 = 35;

const STORAGE_UNIFORM: u32 = 2;
const STORAGE_PUSH_CONSTANT: u32 = 9;
const STORAGE_BUFFER: u32 = 12;

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

/// A buffer or the push constants of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Block {
    PushConstants,
    Buffer { binding: u32 },
}

/// Where a block's members lie.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Offset of each member, by its number.
    pub offsets: Vec<u32>,
    /// Of each member what it is made of, when that is a struct or an array.
    pub members: Vec<Option<Part>>,
}

/// What a member is made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    Struct(Shape),
    /// Distance between elements, and what these are made of.
    Array(u32, Option<Box<Part>>),
}

/// Types and decorations of a module.
#[derive(Default)]
struct Types {
    structs: BTreeMap<u32, Vec<u32>>,
    arrays: BTreeMap<u32, u32>,
    pointers: BTreeMap<u32, u32>,
    strides: BTreeMap<u32, u32>,
    bindings: BTreeMap<u32, u32>,
    offsets: BTreeMap<(u32, u32), u32>,
    variables: Vec<(u32, u32, u32)>,
}

/// The layout of every block that a module uses; several may see one buffer.
pub fn blocks(bytes: &[u8]) -> Vec<(Block, Shape)> {
    let types = Types::of(bytes);
    let blocks = types.variables.iter().filter_map(|&(kind, id, storage)| {
        let block = match storage {
            STORAGE_PUSH_CONSTANT => Block::PushConstants,
            STORAGE_UNIFORM | STORAGE_BUFFER => Block::Buffer {
                binding: types.bindings[&id],
            },
            _ => return None,
        };
        Some((block, types.shape(types.pointers[&kind])))
    });
    blocks.collect()
}

impl Types {
    fn of(bytes: &[u8]) -> Types {
        let mut types = Types::default();
        for instruction in instructions(bytes) {
            let words = &instruction[1..];
            match instruction[0] & 0xffff {
                TYPE_ARRAY | TYPE_RUNTIME_ARRAY => {
                    types.arrays.insert(words[0], words[1]);
                }
                TYPE_STRUCT => {
                    types.structs.insert(words[0], words[1..].to_vec());
                }
                TYPE_POINTER => {
                    types.pointers.insert(words[0], words[2]);
                }
                VARIABLE => types.variables.push((words[0], words[1], words[2])),
                DECORATE if words[1] == ARRAY_STRIDE => {
                    types.strides.insert(words[0], words[2]);
                }
                DECORATE if words[1] == BINDING => {
                    types.bindings.insert(words[0], words[2]);
                }
                MEMBER_DECORATE if words[2] == OFFSET => {
                    types.offsets.insert((words[0], words[1]), words[3]);
                }
                _ => {}
            }
        }
        types
    }

    fn shape(&self, id: u32) -> Shape {
        let members = &self.structs[&id];
        Shape {
            offsets: (0..members.len() as u32)
                .map(|member| self.offsets[&(id, member)])
                .collect(),
            members: members.iter().map(|&member| self.part(member)).collect(),
        }
    }

    fn part(&self, id: u32) -> Option<Part> {
        if self.structs.contains_key(&id) {
            return Some(Part::Struct(self.shape(id)));
        }
        let element = *self.arrays.get(&id)?;
        let element = self.part(element).map(Box::new);
        Some(Part::Array(self.strides[&id], element))
    }
}
