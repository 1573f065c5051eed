//! The render pass of an offscreen picture.

use crate::error::Result;
use crate::gpu::failed;
use crate::gpu::ring::ring_dependency;
use ash::vk;
use vk::{AccessFlags as Access, ImageLayout as Layout, PipelineStageFlags as Stage};

/// The formats and samples of a picture's attachments.
#[derive(Clone, Copy)]
pub(super) struct Formats {
    pub(super) colour: vk::Format,
    pub(super) depth: vk::Format,
    pub(super) samples: vk::SampleCountFlags,
}

impl Formats {
    /// Whether a second colour image takes the resolved picture.
    pub(super) fn resolves(&self) -> bool {
        self.samples != vk::SampleCountFlags::TYPE_1
    }
}

/// What a pass draws of a picture: all passes of a picture are compatible (Vulkan spec, "Render Pass Compatibility": with a single subpass whether it
/// resolves makes no difference).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slice {
    /// All of it.
    Whole,
    /// What comes first; more comes behind.
    First,
    /// What comes neither first nor last.
    Between,
    /// What is left.
    Last,
    /// All of a part, of a picture that is there and stays around it.
    Part,
    /// What is left of a part; [`First`](Slice::First) and [`Between`](Slice::Between) come before it.
    LastOfPart,
}

impl Slice {
    /// Whether it begins the picture.
    pub fn begins(self) -> bool {
        matches!(self, Slice::Whole | Slice::First | Slice::Part)
    }

    /// Whether the picture is there afterwards.
    pub fn ends(self) -> bool {
        !matches!(self, Slice::First | Slice::Between)
    }
}

/// One subpass over attachments 0 colour, 1 depth, and at the end of a picture 2 resolved colour if there are several samples.
///
/// The picture ends in `TRANSFER_SRC_OPTIMAL`, ready to be copied.
///
/// # Safety
/// `device` is live and supports the formats and samples as attachments.
pub(super) unsafe fn create(
    device: &ash::Device,
    formats: Formats,
    slice: Slice,
) -> Result<vk::RenderPass> {
    let mut attachments = vec![colour(formats, slice), depth(formats, slice)];
    let resolves = formats.resolves() && slice.ends();
    if resolves {
        attachments.push(resolved(formats, slice));
    }
    let reference = |attachment, layout| vk::AttachmentReference { attachment, layout };
    let colours = [reference(0, Layout::COLOR_ATTACHMENT_OPTIMAL)];
    let depth = reference(1, Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
    let resolved = [reference(2, Layout::COLOR_ATTACHMENT_OPTIMAL)];
    let mut subpass = vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .color_attachments(&colours)
        .depth_stencil_attachment(&depth);
    if resolves {
        subpass = subpass.resolve_attachments(&resolved);
    }
    let subpasses = [subpass];
    let dependencies = [before(), ring_dependency(0), after()];
    let info = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
    // SAFETY: the device is live and supports the attachments, by this function's contract.
    unsafe { device.create_render_pass(&info, None) }.map_err(failed("vkCreateRenderPass"))
}

fn colour(formats: Formats, slice: Slice) -> vk::AttachmentDescription {
    let layout = match formats.resolves() {
        true => Layout::COLOR_ATTACHMENT_OPTIMAL,
        false => Layout::TRANSFER_SRC_OPTIMAL,
    };
    let is_kept = !(formats.resolves() && slice.ends());
    let attachment = sliced(formats.colour, formats, slice, is_kept, layout);
    match formats.resolves() {
        true => attachment,
        false => stays_around(attachment, slice),
    }
}

fn depth(formats: Formats, slice: Slice) -> vk::AttachmentDescription {
    let layout = Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    sliced(formats.depth, formats, slice, !slice.ends(), layout)
}

/// An attachment that goes from slice to slice.
fn sliced(
    format: vk::Format,
    formats: Formats,
    slice: Slice,
    is_kept: bool,
    layout: Layout,
) -> vk::AttachmentDescription {
    let store = match is_kept {
        true => vk::AttachmentStoreOp::STORE,
        false => vk::AttachmentStoreOp::DONT_CARE,
    };
    let attachment = cleared(format, formats.samples)
        .store_op(store)
        .final_layout(layout);
    match slice.begins() {
        true => attachment,
        false => attachment
            .load_op(vk::AttachmentLoadOp::LOAD)
            .initial_layout(layout),
    }
}

fn resolved(formats: Formats, slice: Slice) -> vk::AttachmentDescription {
    let attachment = cleared(formats.colour, vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::DONT_CARE)
        .store_op(vk::AttachmentStoreOp::STORE)
        .final_layout(Layout::TRANSFER_SRC_OPTIMAL);
    stays_around(attachment, slice)
}

/// The picture's image: what lies around a part stays only where the image does not come from `UNDEFINED` (Vulkan spec, "Render Pass Load Operations":
/// operations are confined to the render area).
fn stays_around(attachment: vk::AttachmentDescription, slice: Slice) -> vk::AttachmentDescription {
    match slice {
        Slice::Part | Slice::LastOfPart => attachment.initial_layout(Layout::TRANSFER_SRC_OPTIMAL),
        _ => attachment,
    }
}

fn cleared(format: vk::Format, samples: vk::SampleCountFlags) -> vk::AttachmentDescription {
    vk::AttachmentDescription::default()
        .format(format)
        .samples(samples)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
        .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
        .initial_layout(Layout::UNDEFINED)
}

/// What came before must be done: the last pass's writes, and the copy of its picture (which the transition from `UNDEFINED`
/// would overwrite).
fn before() -> vk::SubpassDependency {
    let attachments =
        Stage::COLOR_ATTACHMENT_OUTPUT | Stage::EARLY_FRAGMENT_TESTS | Stage::LATE_FRAGMENT_TESTS;
    let writes = Access::COLOR_ATTACHMENT_WRITE | Access::DEPTH_STENCIL_ATTACHMENT_WRITE;
    let reads = Access::COLOR_ATTACHMENT_READ | Access::DEPTH_STENCIL_ATTACHMENT_READ;
    vk::SubpassDependency::default()
        .src_subpass(vk::SUBPASS_EXTERNAL)
        .dst_subpass(0)
        .src_stage_mask(attachments | Stage::TRANSFER)
        .src_access_mask(writes)
        .dst_stage_mask(attachments)
        .dst_access_mask(writes | reads)
}

/// The picture, resolved or not (resolving counts as colour output), is there for the copy.
fn after() -> vk::SubpassDependency {
    vk::SubpassDependency::default()
        .src_subpass(0)
        .dst_subpass(vk::SUBPASS_EXTERNAL)
        .src_stage_mask(Stage::COLOR_ATTACHMENT_OUTPUT)
        .src_access_mask(Access::COLOR_ATTACHMENT_WRITE)
        .dst_stage_mask(Stage::TRANSFER)
        .dst_access_mask(Access::TRANSFER_READ)
}
