//! A picture that is drawn in several passes, one after the other, with other work of the queue between them: what takes long leaves room for that.

use ash::vk;

use super::OffscreenTarget;
use crate::error::Result;
use crate::gpu::failed;
use crate::host::Device;
use crate::host::render_pass::{self, Slice};

/// The passes of pictures that are drawn so, all of them compatible with the one that draws all at once.
pub(super) struct Slices {
    device: Device,
    first: vk::RenderPass,
    between: vk::RenderPass,
    last: vk::RenderPass,
    part: vk::RenderPass,
    last_of_part: vk::RenderPass,
    /// Of colour and depth alone.
    framebuffer: vk::Framebuffer,
}

impl OffscreenTarget {
    /// Makes the passes of [`begin_slice`](Self::begin_slice). Again after [`crop`](Self::crop).
    ///
    /// # Errors
    /// Vulkan's own.
    pub fn allow_slices(&mut self) -> Result<()> {
        let device = self.device.raw();
        let mut slices = Slices {
            device: self.device.clone(),
            first: vk::RenderPass::null(),
            between: vk::RenderPass::null(),
            last: vk::RenderPass::null(),
            part: vk::RenderPass::null(),
            last_of_part: vk::RenderPass::null(),
            framebuffer: vk::Framebuffer::null(),
        };
        // SAFETY: the device is live; formats and samples were checked against its limits.
        let make = |slice| unsafe { render_pass::create(device, self.formats, slice) };
        slices.first = make(Slice::First)?;
        slices.between = make(Slice::Between)?;
        slices.last = make(Slice::Last)?;
        slices.part = make(Slice::Part)?;
        slices.last_of_part = make(Slice::LastOfPart)?;
        let views = [self.images[0].view, self.images[1].view];
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(slices.first)
            .attachments(&views)
            .width(self.part.width)
            .height(self.part.height)
            .layers(1);
        // SAFETY: the views are of this device, in the order and of the formats that the pass declares.
        slices.framebuffer = unsafe { device.create_framebuffer(&info, None) }
            .map_err(failed("vkCreateFramebuffer"))?;
        self.slices = Some(slices);
        Ok(())
    }

    /// The pass that draws all, with its framebuffer.
    pub(super) fn whole(&self) -> (vk::RenderPass, vk::Framebuffer) {
        (self.render_pass, self.framebuffer)
    }

    /// Whether a picture that is begun leaves the last one to be copied until it is done: that is so where there are several samples a pixel.
    pub fn keeps_picture(&self) -> bool {
        self.formats.resolves()
    }

    /// As [`begin`](Self::begin), for a part of what is drawn: the first slice clears, and behind the last one the picture is there. Slices are drawn in
    /// their order, with the same area; other work of the queue may come between them. A ring is used by one pass at a time: behind the first slice
    /// [`cmd_ring_barrier`](crate::gpu::ring::cmd_ring_barrier) comes before each.
    ///
    /// A part ([`Slice::Part`]) is drawn into a picture that is there: what lies around the [area](Self::area) stays as it is. It takes several slices, up to
    /// [`Slice::LastOfPart`], only where the target [keeps its picture](Self::keeps_picture).
    ///
    /// # Panics
    /// Where slices were not [allowed](Self::allow_slices).
    ///
    /// # Safety
    /// As [`begin`](Self::begin); behind the first slice the one before it was executed, and before a part a whole picture.
    pub unsafe fn begin_slice(&self, cmd: vk::CommandBuffer, clear: [f32; 4], slice: Slice) {
        let slices = self.slices.as_ref().expect("slices have been allowed");
        let pass = match slice {
            Slice::Whole => self.whole(),
            Slice::First => (slices.first, slices.framebuffer),
            Slice::Between => (slices.between, slices.framebuffer),
            Slice::Last => (slices.last, self.framebuffer),
            Slice::Part => (slices.part, self.framebuffer),
            Slice::LastOfPart => (slices.last_of_part, self.framebuffer),
        };
        // SAFETY: this function's contract.
        unsafe {
            self.begin_with(cmd, clear, pass, vk::SubpassContents::INLINE);
            self.cmd_set_view(cmd);
        }
    }
}

impl Drop for Slices {
    fn drop(&mut self) {
        if self.device.is_hung() {
            return;
        }
        let device = self.device.raw();
        // SAFETY: all of it was made from this device, which waits for each submission, so nothing is in use; null handles are allowed.
        unsafe {
            device.destroy_framebuffer(self.framebuffer, None);
            let of_parts = [self.part, self.last_of_part];
            for pass in [self.first, self.between, self.last]
                .into_iter()
                .chain(of_parts)
            {
                device.destroy_render_pass(pass, None);
            }
        }
    }
}
