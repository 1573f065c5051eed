//! A device with a picture to draw into: where surfaces are loaded, drawn, captured and measured by whoever has no engine.

mod frame;
mod loaded;

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use ash::vk;

use crate::error::Result;
use crate::frame::{Backend, Batch, Residence, SurfaceOptions};
use crate::gpu::shaders::{Embedded, Modules};
use crate::gpu::{Fill, Layout, PipelineOptions, Pipelines, Target, View};
use crate::host::{Device, OffscreenTarget, Owned, PipelineCache, StatisticsQuery};
use crate::method::Prepared;
use crate::tessellation::Spacing;

pub use frame::{Frame, vertex_bits, vertex_key};
pub use loaded::Loaded;

/// A device, a target, and what surfaces share there: their layouts, and the pipelines, which take long to build and are built once.
///
/// One thread draws and waits, submission by submission.
pub struct Bench {
    device: Device,
    target: OffscreenTarget,
    layout: Owned<Layout>,
    cache: Option<Arc<PipelineCache>>,
    /// None for those that the crate brings.
    modules: Option<Arc<dyn Modules + Send + Sync>>,
    pipelines: RefCell<Vec<(Key, Rc<Owned<Pipelines>>)>>,
    statistics: Option<StatisticsQuery>,
}

/// The shaders of the passes, and how they are drawn.
type Key = (Vec<&'static str>, Style);

/// How surfaces are drawn, as far as pipelines go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Who cuts patches into triangles.
    pub backend: Backend,
    /// Where control points live.
    pub residence: Residence,
    /// The spacing of vertices along edges.
    pub spacing: Spacing,
    /// What becomes of the triangles.
    pub fill: Fill,
    /// Which of them are left out.
    pub cull: vk::CullModeFlags,
    /// How depths are compared.
    pub compare: vk::CompareOp,
    /// How wide lines are, in pixels; at most 1 where the device has no wider ones.
    pub line_width: f32,
    /// Whether patches may be pieces of ones with more than 64 segments.
    pub sub_patches: bool,
}

impl Style {
    /// Both sides of all triangles, the nearer before the farther.
    pub fn new(options: SurfaceOptions, spacing: Spacing, fill: Fill) -> Style {
        Style {
            backend: options.backend,
            residence: options.residence,
            spacing,
            fill,
            cull: vk::CullModeFlags::NONE,
            compare: vk::CompareOp::LESS_OR_EQUAL,
            line_width: 1.0,
            sub_patches: options.has_sub_patches(),
        }
    }

    /// What pipelines are made of that draw so into a picture, or one whose pass is compatible with its own.
    pub fn options(self, target: &OffscreenTarget) -> PipelineOptions<'static> {
        PipelineOptions {
            target: Target {
                samples: target.samples(),
                cull: self.cull,
                compare: self.compare,
                line_width: line_width(target.device(), self.line_width),
                ..Target::render_pass(target.render_pass())
            },
            backend: self.backend,
            residence: self.residence,
            spacing: self.spacing,
            fill: self.fill,
            fragment: None,
            sub_patches: self.sub_patches,
            layout: None,
        }
    }
}

/// The nearest to a width that a device draws lines of.
fn line_width(device: &Device, wanted: f32) -> f32 {
    let [_, greatest] = device.limits().line_width_range;
    match device.info().support.optional.wide_lines {
        true => wanted.min(greatest),
        false => wanted.min(1.0),
    }
}

/// Batches that are drawn with the same pipelines, as seen in the same view, once or as often as there are instances.
#[derive(Clone, Debug)]
pub struct Shot<'s> {
    /// The pipelines.
    pub pipelines: &'s Pipelines,
    /// The view.
    pub view: View,
    /// How many instances there are, which all are seen alike; 1 where control points are in the ring.
    pub instances: u32,
    /// The batches.
    pub batches: Vec<Batch<'s>>,
}

impl Bench {
    /// What surfaces need that are drawn into a target, on its device.
    ///
    /// # Errors
    /// Vulkan's own.
    pub fn new(target: OffscreenTarget) -> Result<Bench> {
        let device = target.device().clone();
        let counts = device.info().support.optional.pipeline_statistics_query;
        let statistics = counts.then(|| StatisticsQuery::new(&device)).transpose()?;
        // SAFETY: the device is live.
        let layout = unsafe { Layout::new(device.raw(), device.enabled()) }?;
        Ok(Bench {
            target,
            statistics,
            // SAFETY: the layout was just made by this device.
            layout: unsafe { Owned::new(&device, layout) },
            pipelines: RefCell::default(),
            cache: None,
            modules: None,
            device,
        })
    }

    /// The same, where pipelines are built with what a cache of its device holds, and are added to it.
    pub fn with_cache(self, cache: Option<Arc<PipelineCache>>) -> Bench {
        Bench { cache, ..self }
    }

    /// The same, where pipelines are built from other modules than those that the crate brings.
    ///
    /// # Safety
    /// They are valid SPIR-V for its device, with the interfaces that ours have.
    pub unsafe fn with_modules(self, modules: Arc<dyn Modules + Send + Sync>) -> Bench {
        Bench {
            modules: Some(modules),
            ..self
        }
    }

    /// Where its modules are from.
    fn modules(&self) -> &dyn Modules {
        match &self.modules {
            Some(modules) => &**modules,
            None => &Embedded,
        }
    }

    /// Its device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// What it draws into.
    pub fn target(&self) -> &OffscreenTarget {
        &self.target
    }

    /// The same, to be confined.
    pub fn target_mut(&mut self) -> &mut OffscreenTarget {
        &mut self.target
    }

    /// The layouts of all surfaces.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The pipelines for a prepared model, built once and kept.
    ///
    /// # Errors
    /// As [`Pipelines::new`].
    pub fn pipelines(&self, prepared: &Prepared, style: Style) -> Result<Rc<Owned<Pipelines>>> {
        let shaders = prepared.passes.iter().map(|pass| pass.shader);
        let key = (shaders.collect(), style);
        let kept = |all: &[(Key, Rc<Owned<Pipelines>>)]| {
            let found = all.iter().find(|(other, _)| *other == key);
            found.map(|(_, pipelines)| pipelines.clone())
        };
        if let Some(pipelines) = kept(&self.pipelines.borrow()) {
            return Ok(pipelines);
        }
        let built = Rc::new(self.build(prepared, style, self.cache())?);
        self.pipelines.borrow_mut().push((key, built.clone()));
        Ok(built)
    }

    fn cache(&self) -> vk::PipelineCache {
        let raw = self.cache.as_ref().map(|cache| cache.raw());
        raw.unwrap_or_default()
    }

    /// Forgets all pipelines that it has built, and builds and keeps new ones with a cache of this device.
    ///
    /// # Errors
    /// As [`Pipelines::new`].
    pub fn rebuild(
        &self,
        prepared: &Prepared,
        style: Style,
        cache: vk::PipelineCache,
    ) -> Result<()> {
        let mut kept = self.pipelines.borrow_mut();
        kept.clear();
        let shaders = prepared.passes.iter().map(|pass| pass.shader);
        let built = self.build(prepared, style, cache)?;
        kept.push(((shaders.collect(), style), Rc::new(built)));
        Ok(())
    }

    /// Pipelines that are built anew, with a cache of this device, or none.
    ///
    /// # Errors
    /// As [`Pipelines::new`].
    pub fn build(
        &self,
        prepared: &Prepared,
        style: Style,
        cache: vk::PipelineCache,
    ) -> Result<Owned<Pipelines>> {
        let options = style.options(&self.target);
        let from = self.modules();
        let device = self.device.raw();
        // SAFETY: all of one live device.
        let built = unsafe {
            Pipelines::with_modules(device, &self.layout, cache, prepared, &options, from)
        };
        // SAFETY: they were just made by this device.
        built.map(|pipelines| unsafe { Owned::new(&self.device, pipelines) })
    }
}
