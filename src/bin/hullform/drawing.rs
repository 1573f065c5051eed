//! A model on the device, ready to be drawn or captured.

use std::ops::Deref;
use std::time::Instant;

use ash::vk;
use hullform::gpu::{
    Backend, Batch, CachePipelines, Counters, Cut, DrawList, Fill, Layout, PipelineOptions,
    Pipelines, PointPipeline, Residence, Slots, SurfaceOptions, Target, TessellatedSurface, View,
};
use hullform::host::OffscreenTarget;
use hullform::mesh::Model;
use hullform::method::{DepthTags, Displacement, Prepared};
use hullform::tessellation::Spacing;
use hullform::{Error, Result};

use crate::adaptive::{Adaptive, Seen};
use crate::approximation;
use crate::camera;
use crate::gpu::Gpu;
use crate::options::{Chosen, Cutting, Points};

/// A model on the device, and how long it took to get there.
pub struct Drawing<'a> {
    gpu: &'a Gpu,
    layout: Option<Layout>,
    surface: Option<TessellatedSurface>,
    /// Where control points are cached.
    cache_pipelines: Option<CachePipelines>,
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
        let prepared = Drawing::prepare(model, chosen)?;
        let plan_seconds = started.elapsed().as_secs_f64();
        let mut drawing = Drawing::of(gpu, model, prepared, options)?;
        drawing.plan_seconds = plan_seconds;
        Ok(drawing)
    }

    /// Prepares a model by a method, and says when that only approximates what nobody asked to be approximated.
    pub fn prepare(model: &Model, chosen: Chosen) -> Result<Prepared> {
        let (prepared, refusals) = chosen.prepare(model)?;
        if chosen.by_default {
            approximation::tell(model, &prepared, &refusals)?;
        }
        Ok(prepared)
    }

    /// Brings a model that has been prepared to the device.
    pub fn of(
        gpu: &'a Gpu,
        model: &Model,
        prepared: Prepared,
        options: SurfaceOptions,
    ) -> Result<Drawing<'a>> {
        if options.backend == Backend::Geometry
            && !gpu.device.info().support.optional.geometry_shader
        {
            return Err(Error::Option {
                option: "--backend",
                problem: format!("{} has no geometry shaders", gpu.device.info().name),
                remedy: "choose another device, or the backend pattern or tessellator".into(),
            });
        }
        let device = gpu.device.raw();
        let mut drawing = Drawing {
            gpu,
            layout: None,
            surface: None,
            cache_pipelines: None,
            plan_seconds: 0.0,
            upload_seconds: 0.0,
        };
        // SAFETY: the device is live and was opened with every feature that `Support` asks for.
        let layout = drawing
            .layout
            .insert(unsafe { Layout::new(device, gpu.device.enabled())? });
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
        let prepared = drawing.surface.insert(surface).prepared();
        if options.residence == Residence::Cache {
            let cache = vk::PipelineCache::null();
            // SAFETY: as above.
            let pipelines = unsafe { CachePipelines::new(device, layout, cache, prepared)? };
            drawing.cache_pipelines = Some(pipelines);
        }
        Ok(drawing)
    }

    /// Copies everything to the device, which computes points again if it is asked to.
    pub fn upload(&mut self, points: Points) -> Result<()> {
        let started = Instant::now();
        let (gpu, device) = (self.gpu, self.gpu.device.raw());
        let on_device = (points == Points::Device).then(|| {
            // SAFETY: the device is live, the layout its own.
            unsafe { PointPipeline::new(device, self.layout(), vk::PipelineCache::null()) }
        });
        let pipeline = on_device.transpose()?;
        let uploaded = gpu.device.submit(|cmd| {
            // SAFETY: recording on the device that made everything, outside of a render pass; the upload makes control vertices visible.
            unsafe {
                self.surface_mut().cmd_upload(device, cmd);
                if let Some(pipeline) = &pipeline {
                    self.surface()
                        .cmd_points(device, cmd, self.layout(), pipeline);
                }
            }
            Ok(())
        });
        if let Some(pipeline) = pipeline.filter(|_| !gpu.device.is_hung()) {
            // SAFETY: the submission has been waited for.
            unsafe { pipeline.destroy(device) };
        }
        uploaded?;
        let surface = self.surface_mut();
        // SAFETY: the upload has been waited for.
        unsafe { surface.finish_upload(gpu.device.raw(), &mut gpu.device.allocator()) };
        self.upload_seconds = started.elapsed().as_secs_f64();
        Ok(())
    }

    /// The surface.
    pub fn surface(&self) -> &TessellatedSurface {
        self.surface.as_ref().expect("there from new to drop")
    }

    fn surface_mut(&mut self) -> &mut TessellatedSurface {
        self.surface.as_mut().expect("there from new to drop")
    }

    /// The depth tags that a cutting asks for, as seen in a picture of `size` pixels.
    pub fn tags(
        &self,
        model: &Model,
        cutting: Cutting,
        view: &camera::View,
        size: [f32; 2],
    ) -> Result<Option<DepthTags>> {
        let seen = Seen {
            clip_from_model: view.clip_from_model,
            eye: view.eye,
            scale: model.placement().scale,
            size,
        };
        let outline = &self.surface().prepared().outline;
        let level = cutting.cut.level;
        let tags = |adaptive: Adaptive| adaptive.tags(outline, &model.positions(), level, seen);
        cutting.adaptive.map(tags).transpose()
    }

    /// What is drawn at a cut, with what the host decides about patches on the device, and control points in their cache.
    pub fn draw_list(&mut self, cut: Cut, tags: Option<&DepthTags>) -> Result<DrawList> {
        let list = self.surface().draw_list(cut, tags)?;
        self.bring(&list)?;
        let device = &self.gpu.device;
        if self.cache_pipelines.is_some() {
            // SAFETY: recording on the device that made everything, outside of a render pass.
            device.submit(|cmd| unsafe { self.cmd_cache(cmd, &list) })?;
        }
        Ok(list)
    }

    /// Says that what is cached is to be computed again.
    pub fn positions_changed(&mut self) {
        self.surface_mut().positions_changed();
    }

    /// Records the computation of the control points that a list needs and no cache has, if they are cached; how many these are.
    ///
    /// # Safety
    /// As [`TessellatedSurface::cmd_cache`].
    pub unsafe fn cmd_cache(&mut self, cmd: vk::CommandBuffer, list: &DrawList) -> Result<u32> {
        let (Some(layout), Some(surface)) = (&self.layout, &mut self.surface) else {
            return Ok(0);
        };
        let device = self.gpu.device.raw();
        let pipelines = self.cache_pipelines.as_ref();
        pipelines.map_or(Ok(0), |pipelines| {
            // SAFETY: this function's contract.
            unsafe { surface.cmd_cache(device, cmd, layout, pipelines, list) }
        })
    }

    /// Brings to the device what the host decided about patches, unless it was the last to be brought.
    pub fn bring(&mut self, list: &DrawList) -> Result<()> {
        let device = &self.gpu.device;
        let surface = self.surface_mut();
        // SAFETY: device and allocator made the surface; every submission has been waited for.
        unsafe { surface.write_draws(device.raw(), &mut device.allocator(), list) }
    }

    /// The pipelines for a target, which go when they are dropped.
    pub fn pipelines(
        &self,
        target: &OffscreenTarget,
        spacing: Spacing,
        fill: Fill,
    ) -> Result<OwnPipelines<'a>> {
        let device = self.gpu.device.raw();
        let options = self.surface().options();
        let options = PipelineOptions {
            target: Target {
                samples: target.samples(),
                ..Target::render_pass(target.render_pass())
            },
            backend: options.backend,
            residence: options.residence,
            spacing,
            fill,
            fragment: None,
            layout: None,
        };
        // SAFETY: all of one live device.
        let pipelines = unsafe {
            Pipelines::new(
                device,
                self.layout(),
                vk::PipelineCache::null(),
                self.surface().prepared(),
                &options,
            )?
        };
        Ok(OwnPipelines {
            gpu: self.gpu,
            pipelines: Some(pipelines),
        })
    }

    /// A view for draws of which nothing is seen.
    pub fn nowhere() -> View {
        View {
            clip_from_model: [[0.0; 4]; 4],
            eye: [0.0; 3],
            displacement: Displacement::default(),
        }
    }

    fn layout(&self) -> &Layout {
        self.layout.as_ref().expect("there from new to drop")
    }

    /// Records the draws of batches with some pipelines, seen with the one view that `cmd_prepare` was given.
    ///
    /// # Safety
    /// As [`TessellatedSurface::cmd_draw`].
    pub unsafe fn cmd_draw<'l>(
        &self,
        cmd: vk::CommandBuffer,
        pipelines: &Pipelines,
        batches: impl IntoIterator<Item = Batch<'l>>,
    ) -> Result<()> {
        let (device, layout) = (self.gpu.device.raw(), self.layout());
        for batch in batches {
            // SAFETY: this function's contract.
            unsafe {
                self.surface()
                    .cmd_draw(device, cmd, layout, pipelines, 0..1, batch)?;
            }
        }
        Ok(())
    }

    /// What the control shaders counted in the last submission.
    pub fn counters(&self) -> Result<Counters> {
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

/// Pipelines that go when they are dropped, whatever fails in between.
pub struct OwnPipelines<'a> {
    gpu: &'a Gpu,
    pipelines: Option<Pipelines>,
}

impl Deref for OwnPipelines<'_> {
    type Target = Pipelines;

    fn deref(&self) -> &Pipelines {
        self.pipelines
            .as_ref()
            .expect("there until they are dropped")
    }
}

impl Drop for OwnPipelines<'_> {
    fn drop(&mut self) {
        let device = &self.gpu.device;
        // A queue that hangs may still use them.
        if let Some(pipelines) = self.pipelines.take().filter(|_| !device.is_hung()) {
            // SAFETY: every submission has been waited for.
            unsafe { pipelines.destroy(device.raw()) };
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
            if let Some(pipelines) = self.cache_pipelines.take() {
                pipelines.destroy(device);
            }
            if let Some(layout) = self.layout.take() {
                layout.destroy(device);
            }
        }
    }
}
