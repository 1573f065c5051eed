//! A model on whatever Vulkan device there is, drawn and captured on a bench of the library's.

mod cuts;
mod poses;

use std::ops::{Deref, DerefMut};

use ash::vk;
use hullform::gpu::{
    Backend, Batch, Cut, DrawList, Fill, Pipelines, Residence, SurfaceOptions, View, Workaround,
};
use hullform::host::{
    self, Bench, Device, Encoding, Instance, OffscreenTarget, Owned, Shot, Style,
};
use hullform::mesh::Model;
use hullform::method::{Displacement, Prepared};
use hullform::tessellation::Spacing;
use hullform::{Error, Result};

pub use cuts::{SPACINGS, capturing, cut, over_patches, prepare, vertices};
pub use hullform::host::{Frame, vertex_bits as bits};

/// The side of the picture that everything is drawn into.
pub const SIDE: u32 = 64;

/// A validated device with all that surfaces share. [`Gpu::finish`] ends it.
pub struct Gpu {
    bench: Bench,
    pub device: Device,
    instance: Instance,
}

/// A model on it. Whatever comes twice has the same bits, or the test fails.
pub struct Loaded<'a> {
    loaded: host::Loaded<'a>,
    gpu: &'a Gpu,
}

impl Gpu {
    /// The device, or `None` (with a line that says so) where there is no Vulkan, or no validation layer, to test with.
    pub fn open() -> Option<Gpu> {
        Gpu::open_with(true)
    }

    /// The same with or without validation, which keeps records of its own.
    pub fn open_with(validation: bool) -> Option<Gpu> {
        let opened = Instance::new(validation)
            .and_then(|instance| Ok((Device::open(&instance, None)?, instance)));
        let (device, instance) = match opened {
            Ok(opened) => opened,
            Err(error @ (Error::NoDevice(_) | Error::Option { .. })) => {
                println!("skipped: {error}");
                return None;
            }
            Err(error) => panic!("{error}"),
        };
        let target = OffscreenTarget::with_encoding(&device, SIDE, SIDE, 1, Encoding::Unorm);
        let target = target.expect("a small picture fits every device");
        Some(Gpu {
            bench: Bench::new(target).expect("every device has such layouts"),
            device,
            instance,
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
            gpu: self,
        })
    }

    /// Closes the device and expects that the validation layer never had anything to say.
    pub fn finish(self) {
        let instance = self.instance.clone();
        drop(self);
        let messages = instance.validation_messages();
        assert!(messages.is_empty(), "{}", messages.join("\n"));
    }

    /// Pipelines that go when they are dropped.
    pub fn build(
        &self,
        prepared: &Prepared,
        (backend, residence): (Backend, Residence),
        spacing: Spacing,
        fill: Fill,
        compare: vk::CompareOp,
    ) -> Owned<Pipelines> {
        let style = Style {
            backend,
            residence,
            compare,
            ..Style::new(SurfaceOptions::default(), spacing, fill)
        };
        let built = self.bench.build(prepared, style, vk::PipelineCache::null());
        built.expect("the shipped modules make pipelines")
    }
}

impl Deref for Gpu {
    type Target = Bench;

    fn deref(&self) -> &Bench {
        &self.bench
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
        self.loaded.capture(cut, fill).map(steady)
    }

    /// Draws batches in one submission. All that is captured counts as one pass's.
    pub fn draw(&self, cut: Cut, fill: Fill, batches: &[Batch<'_>]) -> Result<Frame> {
        self.loaded.draw_batches(cut, fill, batches).map(steady)
    }

    /// Draws with some pipelines after the other into one picture, each time all batches of a list, displaced.
    pub fn draw_over(&self, list: &DrawList, all: &[(&Pipelines, Displacement)]) -> Vec<u8> {
        let shots = (0..)
            .zip(all)
            .map(|(round, &(pipelines, displacement))| Shot {
                pipelines,
                view: View {
                    displacement,
                    ..self.view
                },
                instances: 1,
                batches: list.round(round).expect("as many as options say").collect(),
            });
        let shots: Vec<Shot<'_>> = shots.collect();
        self.loaded.draw(&shots).expect("it is executed");
        self.pixels()
    }

    /// The picture of the last draw, four bytes a pixel.
    pub fn pixels(&self) -> Vec<u8> {
        self.gpu.target().read_pixels().to_vec()
    }
}

fn steady(frame: Frame) -> Frame {
    assert_eq!(frame.differing, 0, "two runs of a vertex, two results");
    frame
}
