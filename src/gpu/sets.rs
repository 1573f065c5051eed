//! What the descriptor sets have at their bindings. Sets follow lifetimes: tables, pose, frame.

use ash::vk;

use crate::abi;

/// Stages that see the push constants.
pub(super) const STAGES: vk::ShaderStageFlags =
    vk::ShaderStageFlags::from_raw(DRAWING.as_raw() | vk::ShaderStageFlags::COMPUTE.as_raw());

/// Stages that see what is drawn.
const DRAWING: vk::ShaderStageFlags = vk::ShaderStageFlags::ALL_GRAPHICS;

/// Stages between which the ring hands on control points.
const RING: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::TESSELLATION_CONTROL.as_raw()
        | vk::ShaderStageFlags::TESSELLATION_EVALUATION.as_raw(),
);

/// Stages that evaluate patches, or cut them.
const BEFORE_FRAGMENTS: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    RING.as_raw() | vk::ShaderStageFlags::VERTEX.as_raw() | vk::ShaderStageFlags::GEOMETRY.as_raw(),
);

/// The same, and those that compute.
const EVALUATING: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    BEFORE_FRAGMENTS.as_raw() | vk::ShaderStageFlags::COMPUTE.as_raw(),
);

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

/// What positions decide. Fragments are made of what has been evaluated.
pub(super) const POSE: &[Slot] = &[
    (abi::BINDING_POSITIONS, STORAGE, EVALUATING),
    (abi::BINDING_POINTS, STORAGE, EVALUATING),
    (abi::BINDING_LIMITS, STORAGE, vk::ShaderStageFlags::COMPUTE),
];

/// What a frame decides, and what the device writes in it.
pub(super) const FRAME: &[Slot] = &[
    (abi::BINDING_SCRATCH, STORAGE, RING),
    (abi::BINDING_COUNTERS, STORAGE, RING),
    (abi::BINDING_DRAWS, STORAGE, STAGES),
    (abi::BINDING_CAPTURE, STORAGE, BEFORE_FRAGMENTS),
    (
        abi::BINDING_INSTANCES,
        STORAGE,
        vk::ShaderStageFlags::VERTEX,
    ),
    (abi::BINDING_VIEWS, STORAGE, STAGES),
];

/// How many storage buffers a stage sees, the one that sees most.
pub(super) const STORAGE_BUFFERS: u32 = {
    let stages = [
        vk::ShaderStageFlags::VERTEX,
        vk::ShaderStageFlags::TESSELLATION_CONTROL,
        vk::ShaderStageFlags::TESSELLATION_EVALUATION,
        vk::ShaderStageFlags::GEOMETRY,
        vk::ShaderStageFlags::FRAGMENT,
        vk::ShaderStageFlags::COMPUTE,
    ];
    let (mut most, mut stage) = (0, 0);
    while stage < stages.len() {
        let seen = storage_buffers(stages[stage]);
        most = if seen > most { seen } else { most };
        stage += 1;
    }
    most
};

/// How many storage buffers a stage sees.
pub(super) const fn storage_buffers(stage: vk::ShaderStageFlags) -> u32 {
    let (sets, mut set, mut count) = ([TABLES, POSE, FRAME], 0, 0);
    while set < sets.len() {
        let mut slot = 0;
        while slot < sets[set].len() {
            let (_, kind, stages) = sets[set][slot];
            if kind.as_raw() == STORAGE.as_raw() && stages.as_raw() & stage.as_raw() != 0 {
                count += 1;
            }
            slot += 1;
        }
        set += 1;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_stage_sees_more_than_eight_storage_buffers_and_fragments_leave_room_for_the_engines() {
        assert_eq!(STORAGE_BUFFERS, 8);
        let fragments = storage_buffers(vk::ShaderStageFlags::FRAGMENT);
        assert!(fragments <= 4, "{fragments}");
    }
}
