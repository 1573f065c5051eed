//! What the descriptor sets have at their bindings. Sets follow lifetimes: tables, pose, frame.

use ash::vk;

use crate::abi;

/// Stages that see the push constants.
pub(super) const STAGES: vk::ShaderStageFlags =
    vk::ShaderStageFlags::from_raw(DRAWING.as_raw() | vk::ShaderStageFlags::COMPUTE.as_raw());

/// Stages that see what is drawn.
const DRAWING: vk::ShaderStageFlags = vk::ShaderStageFlags::ALL_GRAPHICS;

/// What a set has at a binding, and which stages see it.
pub(super) type Slot = (u32, vk::DescriptorType, vk::ShaderStageFlags);

const STORAGE: vk::DescriptorType = vk::DescriptorType::STORAGE_BUFFER;
const UNIFORM: vk::DescriptorType = vk::DescriptorType::UNIFORM_BUFFER;

/// What topology decides.
pub(super) const TABLES: &[Slot] = &[
    (abi::BINDING_TABLES, STORAGE, STAGES),
    (abi::BINDING_BASES, UNIFORM, STAGES),
    (
        abi::BINDING_POINT_ROWS,
        STORAGE,
        vk::ShaderStageFlags::COMPUTE,
    ),
    (
        abi::BINDING_POINT_TERMS,
        STORAGE,
        vk::ShaderStageFlags::COMPUTE,
    ),
];

/// What positions decide.
pub(super) const POSE: &[Slot] = &[
    (abi::BINDING_POSITIONS, STORAGE, STAGES),
    (abi::BINDING_POINTS, STORAGE, STAGES),
];

/// What a frame decides, and what the device writes in it.
pub(super) const FRAME: &[Slot] = &[
    (abi::BINDING_SCRATCH, STORAGE, DRAWING),
    (abi::BINDING_COUNTERS, STORAGE, DRAWING),
    (abi::BINDING_DRAWS, STORAGE, DRAWING),
    (abi::BINDING_CAPTURE, STORAGE, DRAWING),
    (abi::BINDING_INSTANCES, STORAGE, DRAWING),
    (abi::BINDING_VIEWS, UNIFORM, DRAWING),
];

/// How many storage buffers a stage sees, the one that sees most.
pub(super) const STORAGE_BUFFERS: u32 = {
    let mut count = 0;
    let sets = [TABLES, POSE, FRAME];
    let mut set = 0;
    while set < sets.len() {
        let mut slot = 0;
        while slot < sets[set].len() {
            let (_, kind, stages) = sets[set][slot];
            if kind.as_raw() == STORAGE.as_raw() && stages.as_raw() & DRAWING.as_raw() != 0 {
                count += 1;
            }
            slot += 1;
        }
        set += 1;
    }
    count
};
