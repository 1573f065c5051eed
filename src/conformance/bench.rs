//! Our surfaces on the device.

use std::cell::Cell;
use std::ops::{Deref, DerefMut};
use std::rc::Rc;

use crate::conformance::pictures;
use crate::error::Result;
use crate::gpu::{Cut, Fill, Shading, SurfaceOptions, Workaround};
use crate::host::{self, Device, Encoding, Frame, OffscreenTarget, PipelineCache, Style};
use crate::mesh::Model;
use crate::method::Prepared;
use crate::tessellation::Spacing;

/// How many vertices, words or pixels the case that runs has seen of what it drew.
pub type Seen = Rc<Cell<u64>>;

/// The side of the picture that surfaces are drawn into.
pub const SIDE: u32 = 256;

/// A bench, kept from case to case, that counts the vertices and pixels which come back.
pub struct Bench {
    bench: host::Bench,
    seen: Seen,
}

/// A model on it.
pub struct Loaded<'a> {
    loaded: host::Loaded<'a>,
    seen: &'a Seen,
}

impl Bench {
    /// What surfaces need on a device.
    pub fn new(device: &Device, seen: &Seen) -> Result<Bench> {
        let target = OffscreenTarget::with_encoding(device, SIDE, SIDE, 1, Encoding::Unorm)?;
        Ok(Bench {
            bench: host::Bench::new(target)?,
            seen: seen.clone(),
        })
    }

    /// Brings a prepared model to the device.
    pub fn load(
        &self,
        model: &Model,
        prepared: Prepared,
        workarounds: &[&'static Workaround],
        options: SurfaceOptions,
    ) -> Result<Loaded<'_>> {
        Ok(Loaded {
            loaded: self.bench.load(model, prepared, workarounds, options)?,
            seen: &self.seen,
        })
    }

    /// Builds pipelines with a cache that holds `data`, from which those are made that surfaces are drawn with from then on, and returns what the
    /// cache holds then.
    pub fn rebuild(
        &self,
        prepared: &Prepared,
        spacing: Spacing,
        fill: Fill,
        data: &[u8],
    ) -> Result<Vec<u8>> {
        // SAFETY: the data are empty or what this device gave.
        let cache = unsafe { PipelineCache::new(self.bench.device(), data) }?;
        let style = Style::new(SurfaceOptions::default(), spacing, fill);
        self.bench.rebuild(prepared, style, cache.raw())?;
        cache.data()
    }
}

impl<'a> Deref for Loaded<'a> {
    type Target = host::Loaded<'a>;

    fn deref(&self) -> &host::Loaded<'a> {
        &self.loaded
    }
}

impl<'a> DerefMut for Loaded<'a> {
    fn deref_mut(&mut self) -> &mut host::Loaded<'a> {
        &mut self.loaded
    }
}

impl Loaded<'_> {
    /// Draws everything at a cut, a pass after the other.
    pub fn capture(&mut self, cut: Cut, fill: Fill) -> Result<Frame> {
        let frame = self.loaded.capture(cut, fill)?;
        self.saw(frame.passes.iter().map(Vec::len).sum());
        Ok(frame)
    }

    /// Draws everything at a cut into one picture: the alpha of its pixels, 0 where nothing is.
    pub fn picture(&mut self, cut: Cut) -> Result<Vec<u8>> {
        let pixels = self.loaded.picture(cut, Fill::Solid(Shading::Patch))?;
        pictures::drew(|| pictures::Picture {
            width: SIDE,
            pixels: pixels.to_vec(),
        });
        let alphas: Vec<u8> = pixels.iter().copied().skip(3).step_by(4).collect();
        self.saw(alphas.iter().filter(|&&alpha| alpha != 0).count());
        Ok(alphas)
    }

    fn saw(&self, count: usize) {
        self.seen.set(self.seen.get() + count as u64);
    }
}
