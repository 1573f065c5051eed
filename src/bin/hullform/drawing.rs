//! A model on the device, ready to be drawn or captured.

use std::ops::{Deref, DerefMut};
use std::time::Instant;

use hullform::gpu::{Backend, Batch, Slots, SurfaceOptions, View};
use hullform::host::{Bench, Loaded, OffscreenTarget};
use hullform::mesh::Model;
use hullform::method::{DepthTags, Displacement, Prepared};
use hullform::{Error, Result};

use crate::adaptive::{Adaptive, Seen};
use crate::approximation;
use crate::camera;
use crate::gpu::Gpu;
use crate::options::{self, Chosen, Cutting, Points};

/// A model on the device, and how long it took to get there.
pub struct Drawing<'a> {
    loaded: Loaded<'a>,
    /// Seconds to bring everything to the device.
    pub upload_seconds: f64,
}

/// A bench for what is not seen: nothing is rasterised, but draws need a render pass.
pub fn blind(gpu: &Gpu) -> Result<Bench> {
    gpu.bench(OffscreenTarget::new(&gpu.device, 1, 1, 1)?)
}

/// Prepares a model by a method, and says when that only approximates what nobody asked to be approximated.
pub fn prepare(model: &Model, chosen: Chosen) -> Result<Prepared> {
    let (prepared, refusals) = chosen.prepare(model)?;
    if chosen.by_default {
        approximation::tell(model, &prepared, &refusals)?;
    }
    Ok(prepared)
}

/// A view for draws of which nothing is seen: everything is beyond the right side.
pub fn nowhere() -> View {
    View {
        clip_from_model: [[0.0; 4], [0.0; 4], [0.0; 4], [2.0, 0.0, 0.0, 1.0]],
        eye: [0.0; 3],
        displacement: Displacement::default(),
    }
}

/// The depth tags that a cutting asks for, of what was prepared, as seen in a picture of `size` pixels.
pub fn tags_for(
    model: &Model,
    prepared: &Prepared,
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
    let (outline, level) = (&prepared.outline, cutting.cut.level);
    let tags = |adaptive: Adaptive| adaptive.tags(outline, &model.positions(), level, seen);
    cutting.adaptive.map(tags).transpose()
}

/// Who gives slots.
pub fn slots(slots: options::Slots) -> Slots {
    match slots {
        options::Slots::Counter => Slots::Counter,
        options::Slots::Host => Slots::Host,
    }
}

impl<'a> Drawing<'a> {
    /// Brings a model that has been prepared to the device.
    pub fn new(
        gpu: &Gpu,
        bench: &'a Bench,
        model: &Model,
        prepared: Prepared,
        options: SurfaceOptions,
        points: Points,
    ) -> Result<Drawing<'a>> {
        let info = gpu.device.info();
        if options.backend == Backend::Geometry && !info.support.optional.geometry_shader {
            return Err(Error::Option {
                option: "--backend",
                problem: format!("{} has no geometry shaders", info.name),
                remedy: "choose another device, or the backend pattern or tessellator".into(),
            });
        }
        let mut loaded = bench.place(model, prepared, &gpu.workarounds, options)?;
        let started = Instant::now();
        loaded.upload(points == Points::Device)?;
        Ok(Drawing {
            loaded,
            upload_seconds: started.elapsed().as_secs_f64(),
        })
    }

    /// The depth tags that a cutting asks for, as seen in a picture of `size` pixels.
    pub fn tags_for(
        &self,
        model: &Model,
        cutting: Cutting,
        view: &camera::View,
        size: [f32; 2],
    ) -> Result<Option<DepthTags>> {
        tags_for(model, self.prepared(), cutting, view, size)
    }

    /// Refuses a draw of batches, the last there was, of which something is missing: for want of room in the ring, or because the device lost it.
    pub fn check<'l>(&self, batches: impl IntoIterator<Item = Batch<'l>>) -> Result<()> {
        match self.surface().counters()?.overflows {
            0 => self.surface().arrival(batches)?.check(),
            patches => Err(Error::Refused(format!(
                "{patches} patches found no room in the scratch ring; use --slots host, or a larger --ring-bytes"
            ))),
        }
    }
}

impl<'a> Deref for Drawing<'a> {
    type Target = Loaded<'a>;

    fn deref(&self) -> &Loaded<'a> {
        &self.loaded
    }
}

impl<'a> DerefMut for Drawing<'a> {
    fn deref_mut(&mut self) -> &mut Loaded<'a> {
        &mut self.loaded
    }
}
