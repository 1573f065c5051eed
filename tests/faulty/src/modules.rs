//! Shaders that do other than they say: their SPIR-V is written anew on its way to the driver.

use std::collections::{HashMap, HashSet};
use std::ffi::c_void;

use ash::vk;
use ash::vk::Handle;

use crate::chain::below;
use crate::fault::{Fault, is};

/// Numbers of the SPIR-V specification that are needed here.
mod op {
    pub const ENTRY_POINT: u32 = 15;
    pub const EXECUTION_MODE: u32 = 16;
    pub const CAPABILITY: u32 = 17;
    pub const TYPE_POINTER: u32 = 32;
    pub const STORE: u32 = 62;
    pub const ACCESS_CHAIN: u32 = 65;
    pub const DECORATE: u32 = 71;
    pub const MEMBER_DECORATE: u32 = 72;
    pub const F_ADD: u32 = 129;
    pub const U_LESS_THAN: u32 = 176;
    pub const U_LESS_THAN_EQUAL: u32 = 178;
    pub const CONTROL_BARRIER: u32 = 224;
    pub const MEMORY_BARRIER: u32 = 225;
}

/// Execution models.
mod stage {
    pub const CONTROL: u32 = 1;
    pub const EVALUATION: u32 = 2;
    pub const FRAGMENT: u32 = 4;
    pub const COMPUTE: u32 = 5;
}

/// Decorations of variables and members that the driver fills.
mod built_in {
    pub const DECORATION: u32 = 11;
    pub const CLIP_DISTANCE: u32 = 3;
    pub const CULL_DISTANCE: u32 = 4;
    pub const PRIMITIVE_ID: u32 = 7;
    pub const INVOCATION_ID: u32 = 8;
    pub const LAYER: u32 = 9;
    pub const PATCH_VERTICES: u32 = 14;
    pub const VIEW_INDEX: u32 = 4440;
}

const STORAGE_BUFFER: [u32; 2] = [2, 12];
/// Words before the first instruction, one of which is the bound of all ids.
const HEADER: usize = 5;
const BOUND: usize = 3;

struct Rewriter {
    out: Vec<u32>,
    stage: u32,
    /// Types of pointers to buffers, and pointers of these types.
    buffer_types: HashSet<u32>,
    buffer_pointers: HashSet<u32>,
    /// The operands of sums so far.
    sums: HashMap<u32, [u32; 2]>,
}

/// A module as the fault wants it.
fn rewritten(words: &[u32]) -> Vec<u32> {
    let (header, mut rest) = words.split_at(HEADER);
    let mut rewriter = Rewriter {
        out: header.to_vec(),
        stage: u32::MAX,
        buffer_types: HashSet::new(),
        buffer_pointers: HashSet::new(),
        sums: HashMap::new(),
    };
    while let Some(first) = rest.first() {
        let (instruction, others) = rest.split_at((first >> 16).max(1) as usize);
        let mut instruction = instruction.to_vec();
        if rewriter.change(&mut instruction) {
            rewriter.out.append(&mut instruction);
        }
        rest = others;
    }
    rewriter.out
}

impl Rewriter {
    /// Changes an instruction, and says whether it stays.
    fn change(&mut self, words: &mut [u32]) -> bool {
        let operation = words[0] & 0xffff;
        match operation {
            op::ENTRY_POINT => self.stage = words[1],
            op::EXECUTION_MODE => return change_mode(words),
            op::CAPABILITY if is(Fault::ClipsForCulls) => {
                words[1] = match words[1] {
                    32 => 33,
                    33 => 32,
                    other => other,
                };
            }
            op::TYPE_POINTER if STORAGE_BUFFER.contains(&words[2]) => {
                self.buffer_types.insert(words[1]);
            }
            op::ACCESS_CHAIN if self.buffer_types.contains(&words[1]) => {
                self.buffer_pointers.insert(words[2]);
            }
            op::STORE => return !self.is_lost(words[1]),
            op::DECORATE if words.len() > 3 && words[2] == built_in::DECORATION => {
                words[3] = self.other_built_in(words[3]);
            }
            op::MEMBER_DECORATE if words.len() > 4 && words[3] == built_in::DECORATION => {
                words[4] = self.other_built_in(words[4]);
            }
            op::F_ADD if is(Fault::Reassociates) => self.reassociate(words),
            op::U_LESS_THAN if is(Fault::OneTurnMore) && self.is_tessellation() => {
                words[0] = words[0] & 0xffff_0000 | op::U_LESS_THAN_EQUAL;
            }
            op::CONTROL_BARRIER | op::MEMORY_BARRIER => return !is(Fault::ForgetsBarriers),
            _ => {}
        }
        true
    }

    fn is_tessellation(&self) -> bool {
        [stage::CONTROL, stage::EVALUATION].contains(&self.stage)
    }

    /// Whether a store to this pointer does not happen.
    fn is_lost(&self, pointer: u32) -> bool {
        let of_stage = match self.stage {
            stage::CONTROL => is(Fault::ControlStoresNothing),
            stage::COMPUTE => is(Fault::ComputeStoresNothing),
            _ => false,
        };
        of_stage && self.buffer_pointers.contains(&pointer)
    }

    fn other_built_in(&self, number: u32) -> u32 {
        match number {
            built_in::CLIP_DISTANCE if is(Fault::ClipsForCulls) => built_in::CULL_DISTANCE,
            built_in::CULL_DISTANCE if is(Fault::ClipsForCulls) => built_in::CLIP_DISTANCE,
            built_in::PRIMITIVE_ID if is(Fault::WrongPatchNumber) && self.is_tessellation() => {
                built_in::PATCH_VERTICES
            }
            built_in::PRIMITIVE_ID
                if is(Fault::WrongFragmentNumber) && self.stage == stage::FRAGMENT =>
            {
                built_in::LAYER
            }
            built_in::PATCH_VERTICES
                if is(Fault::WrongPatchVertices) && self.stage == stage::CONTROL =>
            {
                built_in::INVOCATION_ID
            }
            built_in::VIEW_INDEX if is(Fault::WrongViewNumber) && self.is_tessellation() => {
                built_in::PRIMITIVE_ID
            }
            other => other,
        }
    }

    /// (a + b) + c becomes a + (b + c), in a new id.
    fn reassociate(&mut self, words: &mut [u32]) {
        let [_, kind, result, left, right] = *words else {
            return;
        };
        if let Some(&[a, b]) = self.sums.get(&left) {
            let inner = self.out[BOUND];
            self.out[BOUND] += 1;
            self.out.extend([words[0], kind, inner, b, right]);
            (words[3], words[4]) = (a, inner);
        }
        self.sums.insert(result, [left, right]);
    }
}

/// Changes an execution mode, and says whether it stays.
fn change_mode(words: &mut [u32]) -> bool {
    match words[2] {
        // Invocations
        0 if is(Fault::InvokesOnce) => words[3] = 1,
        // SpacingFractionalOdd, SpacingEqual
        3 if is(Fault::EqualSpacing) => words[2] = 1,
        // VertexOrderCw, VertexOrderCcw
        order @ 4..=5 if is(Fault::OtherOrder) => words[2] = 9 - order,
        // PointMode
        10 => return !is(Fault::ForgetsPoints),
        _ => {}
    }
    true
}

unsafe extern "system" fn create_shader_module(
    device: vk::Device,
    info: *const vk::ShaderModuleCreateInfo<'static>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::ShaderModule,
) -> vk::Result {
    // SAFETY: the application's arguments: a module of whole words. The new one lives through the call.
    unsafe {
        let mut info = *info;
        let words = rewritten(std::slice::from_raw_parts(info.p_code, info.code_size / 4));
        (info.p_code, info.code_size) = (words.as_ptr(), 4 * words.len());
        let next: vk::PFN_vkCreateShaderModule = below(device.as_raw(), c"vkCreateShaderModule");
        next(device, &info, callbacks, made)
    }
}

/// The layer's own function of this name.
pub fn function(name: &str) -> Option<*const c_void> {
    (name == "vkCreateShaderModule").then_some(create_shader_module as *const c_void)
}
