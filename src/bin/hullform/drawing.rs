//! A model on the device, ready to be drawn or captured.

use std::time::Instant;

use ash::vk;
use hullform::gpu::{
    Batch, Counters, Cut, Fill, Layout, Pipelines, Slots, SurfaceOptions, Target,
    TessellatedSurface, View,
};
use hullform::host::OffscreenTarget;
use hullform::mesh::Model;
use hullform::{Result, tessellation::Spacing};

use crate::gpu::Gpu;
use crate::options::Chosen;

/// A model on the device, and how long it took to get there.
pub struct Drawing<'a> {
    gpu: &'a Gpu,
    layout: Option<Layout>,
    surface: Option<TessellatedSurface>,
    /// Seconds to make plans.
    pub plan_seconds: f64,
    /// Seconds to bring everything to the device.
    pub upload_seconds: f64,
}

impl<'a> Drawing<'a> {
    /// Prepares a model by a method and brings it to the device.
    pub fn new(
        gpu: &'a Gpu,
        model: &Model,
        chosen: Chosen,
        options: SurfaceOptions,
    ) -> Result<Drawing<'a>> {
        let started = Instant::now();
        let prepared = chosen.prepare(model)?;
        let planned = Instant::now();
        let device = gpu.device.raw();
        let mut drawing = Drawing {
            gpu,
            layout: None,
            surface: None,
            plan_seconds: (planned - started).as_secs_f64(),
            upload_seconds: 0.0,
        };
        // SAFETY: the device is live and was opened with every feature that `Support` asks for.
        let layout = drawing.layout.insert(unsafe { Layout::new(device)? });
        let allocator = &mut gpu.device.allocator();
        // SAFETY: as above; allocator and layout are the device's own.
        let surface = unsafe {
            TessellatedSurface::new(
                device,
                allocator,
                layout,
                model,
                prepared,
                &gpu.workarounds,
                options,
            )?
        };
        drawing.surface = Some(surface);
        Ok(drawing)
    }

    /// Copies everything to the device.
    pub fn upload(&mut self) -> Result<()> {
        let started = Instant::now();
        let gpu = self.gpu;
        gpu.device.submit(|cmd| {
            // SAFETY: recording on the device that made the surface, outside of a render pass.
            unsafe { self.surface().cmd_upload(gpu.device.raw(), cmd) };
            Ok(())
        })?;
        let surface = self.surface.as_mut().expect("there from new to drop");
        // SAFETY: the upload has been waited for.
        unsafe { surface.finish_upload(gpu.device.raw(), &mut gpu.device.allocator()) };
        self.upload_seconds = started.elapsed().as_secs_f64();
        Ok(())
    }

    /// The surface.
    pub fn surface(&self) -> &TessellatedSurface {
        self.surface.as_ref().expect("there from new to drop")
    }

    /// Lets the host give slots for the batches of a cut.
    pub fn write_slots(&mut self, cut: Cut, batches: &[Batch]) {
        self.surface
            .as_mut()
            .expect("there from new to drop")
            .write_slots(cut, batches);
    }

    /// The pipelines for a target.
    pub fn pipelines(
        &self,
        target: &OffscreenTarget,
        spacing: Spacing,
        fill: Fill,
    ) -> Result<Pipelines> {
        let device = self.gpu.device.raw();
        let target = Target {
            render_pass: target.render_pass(),
            samples: target.samples(),
        };
        // SAFETY: all of one live device.
        unsafe {
            Pipelines::new(
                device,
                self.layout(),
                vk::PipelineCache::null(),
                self.surface().prepared(),
                target,
                spacing,
                fill,
            )
        }
    }

    fn layout(&self) -> &Layout {
        self.layout.as_ref().expect("there from new to drop")
    }

    /// Records the draws of batches with some pipelines.
    ///
    /// # Safety
    /// As [`TessellatedSurface::cmd_draw`].
    pub unsafe fn cmd_draw(
        &self,
        cmd: vk::CommandBuffer,
        pipelines: &Pipelines,
        view: &View,
        cut: Cut,
        batches: &[Batch],
    ) {
        for batch in batches {
            // SAFETY: this function's contract.
            unsafe {
                self.surface().cmd_draw(
                    self.gpu.device.raw(),
                    cmd,
                    self.layout(),
                    pipelines,
                    view,
                    cut,
                    batch,
                );
            }
        }
    }

    /// What the control shaders counted in the last submission.
    pub fn counters(&self) -> Counters {
        self.surface().counters()
    }

    /// Who gives slots.
    pub fn slots(slots: crate::options::Slots) -> Slots {
        match slots {
            crate::options::Slots::Counter => Slots::Counter,
            crate::options::Slots::Host => Slots::Host,
        }
    }
}

impl Drop for Drawing<'_> {
    fn drop(&mut self) {
        // A queue that hangs may still use everything.
        if self.gpu.device.is_hung() {
            return;
        }
        let device = self.gpu.device.raw();
        let allocator = &mut self.gpu.device.allocator();
        // SAFETY: every submission has been waited for.
        unsafe {
            if let Some(surface) = self.surface.take() {
                surface.destroy(device, allocator);
            }
            if let Some(layout) = self.layout.take() {
                layout.destroy(device);
            }
        }
    }
}
