//! What all surfaces of the window share on the device: layouts, pipelines with their cache on disk, and how a model gets there.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;

use hullform::ash::vk;
use hullform::gpu::shaders::Modules;
use hullform::gpu::{
    Backend, CachePipelines, DecidePipeline, Decides, DrawList, Layout, Pipelines, Residence,
    Slots, SurfaceOptions, TessellatedSurface,
};
use hullform::host::{Device, OffscreenTarget, Owned, Style};
use hullform::mesh::{ControlMesh, Model};
use hullform::method::{
    Editable, MethodOptions, Prepared, method, method_by_default, prepare_by_default_with,
};
use hullform::plan::Database;
use hullform::{Error, Result};

use super::kept::{Kept, key};
pub use super::kept::{Key, Made as Pipes, Shaders};
use crate::gpu::Gpu;
use crate::options::Global;

/// How a model is prepared and kept on the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// The method; None for the one that draws the model's limit, or comes near.
    pub method: Option<&'static str>,
    /// Who cuts patches.
    pub backend: Backend,
    /// Where control points live.
    pub residence: Residence,
    /// Whether vertices with an odd number of bits are moved, so that cracks show.
    pub amplify: bool,
    /// Who decides about patches, where it is not edited in place: then the host does.
    pub decides: Decides,
    /// Whether it is edited in place, where its method can; control points live in the ring then.
    pub live: bool,
}

/// Vertices of a batch on devices that are software, so that a frame draws a part of a scene; what others do at once.
const BATCH: [u32; 2] = [4096, 1 << 18];

/// What surfaces share. Fields are dropped in this order.
pub struct Context {
    kept: Mutex<Kept>,
    /// Decides about patches, once something is drawn of which the device does.
    deciding: OnceLock<Owned<DecidePipeline>>,
    layout: Owned<Layout>,
    /// A picture like those that are drawn into, which pipelines are made for: it stays when the window changes.
    mould: OffscreenTarget,
    /// The device.
    pub gpu: Gpu,
    /// Options of the command line.
    pub global: Global,
}

/// A model on the device, as one recipe has it.
pub struct Drawn {
    /// What is drawn.
    pub surface: Owned<TessellatedSurface>,
    /// Fills the cache of control points, where there is one.
    pub cache: Option<Owned<CachePipelines>>,
    /// What a frame draws, and for which levels it was decided.
    pub list: Option<DrawList>,
    /// The vertices of that.
    pub vertices: u64,
    /// What is drawn of it where a part of the picture is drawn anew.
    pub few: Option<Few>,
    /// Seconds to prepare it, and to bring it to the device.
    pub seconds: [f64; 2],
    /// Why methods that come before the one that did it refused.
    pub refusals: Vec<String>,
    /// How far larger buffers are, which an edit made.
    pub growth: Growth,
}

/// Some of a surface's patches.
pub struct Few {
    /// They alone.
    pub list: DrawList,
    /// The work that they are, by batch; none where there is nothing to be drawn.
    pub works: Arc<[f64]>,
    /// Their vertices.
    pub vertices: u64,
}

/// How far buffers are that were made larger.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Growth {
    /// There are none.
    #[default]
    Done,
    /// They were made.
    Made,
    /// What is in them was recorded.
    Recorded,
}

impl Drawn {
    /// What pipelines must be for to draw it.
    pub fn key(&self, style: Style) -> Key {
        key(self.surface.prepared(), style)
    }
}

impl Context {
    /// What surfaces share that are drawn in pictures of a format, with so many samples a pixel.
    pub fn new(gpu: Gpu, global: &Global, format: vk::Format, samples: u32) -> Result<Context> {
        let device = &gpu.device;
        // SAFETY: the device is live.
        let layout = unsafe { Layout::new(device.raw(), device.enabled()) }?;
        Ok(Context {
            kept: Mutex::new(Kept::new()),
            deciding: OnceLock::new(),
            // SAFETY: the layout was just made by this device.
            layout: unsafe { Owned::new(device, layout) },
            mould: OffscreenTarget::with_format(device, 1, 1, samples, format)?,
            global: global.clone(),
            gpu,
        })
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.gpu.device
    }

    /// The layouts of all surfaces.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// A picture like those that are drawn into.
    pub fn mould(&self) -> &OffscreenTarget {
        &self.mould
    }

    /// Brings a model to the device that was prepared; with what it is edited by, where it is. Takes its time: for workers.
    pub fn place(
        &self,
        model: &Model,
        readied: Readied,
        recipe: Recipe,
    ) -> Result<(Drawn, Option<Editable>)> {
        let started = Instant::now();
        let _span = tracing::debug_span!("upload").entered();
        let Readied {
            made,
            seconds,
            refusals,
        } = readied;
        let mut drawn = self.upload(model, &made, recipe)?;
        drawn.seconds = [seconds, started.elapsed().as_secs_f64()];
        drawn.refusals = refusals;
        let editable = match made {
            Made::Editable(editable) => Some(*editable),
            Made::Plain(_) => None,
        };
        Ok((drawn, editable))
    }

    fn upload(&self, model: &Model, made: &Made, recipe: Recipe) -> Result<Drawn> {
        let (residence, decides) = match made {
            Made::Editable(_) => (Residence::Ring, Decides::Host),
            Made::Plain(_) => (recipe.residence, recipe.decides),
        };
        let [software, hardware] = BATCH;
        let options = SurfaceOptions {
            backend: recipe.backend,
            residence,
            decides,
            batch_vertices: match self.device().info().is_software() {
                true => software,
                false => hardware,
            },
            ring_bytes: self.global.ring_bytes,
            slots: Slots::Host,
            greatest_level: recipe.backend.greatest_level(),
            rounds: 2,
            views: 2,
            amplify_cracks: recipe.amplify,
            ..SurfaceOptions::default()
        };
        if decides == Decides::Device {
            self.make_deciding()?;
        }
        let (device, layout) = (self.device(), self.layout());
        let workarounds = &self.gpu.workarounds;
        // SAFETY: all of one live device, which was opened with every feature that `Support` asks for.
        let surface = unsafe {
            let memory = &mut device.memory();
            let raw = device.raw();
            match made {
                Made::Plain(prepared) => {
                    let prepared = (**prepared).clone();
                    TessellatedSurface::new(
                        raw,
                        memory,
                        layout,
                        model,
                        prepared,
                        workarounds,
                        options,
                    )
                }
                Made::Editable(editable) => TessellatedSurface::editable(
                    raw,
                    memory,
                    layout,
                    model,
                    editable,
                    workarounds,
                    options,
                ),
            }
        }?;
        // SAFETY: it was just made by this device.
        let mut surface = unsafe { Owned::new(device, surface) };
        let filled = (residence == Residence::Cache).then(|| {
            let (cache, prepared) = (self.gpu.pipeline_cache(), surface.prepared());
            let from = self.shaders().modules;
            // SAFETY: all of one live device; the modules are ours, or what somebody makes of them to look at.
            unsafe { CachePipelines::with_modules(device.raw(), layout, cache, prepared, &*from) }
        });
        // SAFETY: as above.
        let own = |pipelines| unsafe { Owned::new(device, pipelines) };
        let cache = filled.transpose()?.map(own);
        device.submit(|cmd| {
            // SAFETY: recording on the device that made everything, outside of a render pass.
            unsafe { surface.cmd_upload(device.raw(), cmd) };
            Ok(())
        })?;
        // SAFETY: the upload has been waited for.
        unsafe { surface.finish_upload(device.raw(), &mut device.memory()) };
        Ok(Drawn {
            surface,
            cache,
            list: None,
            few: None,
            vertices: 0,
            seconds: [0.0; 2],
            refusals: Vec::new(),
            growth: Growth::Done,
        })
    }

    /// What decides about patches, if it was made.
    pub fn deciding(&self) -> Option<&DecidePipeline> {
        self.deciding.get().map(|pipeline| &**pipeline)
    }

    /// Makes that, unless it is there.
    fn make_deciding(&self) -> Result<()> {
        if self.deciding.get().is_none() {
            let (device, cache) = (self.device(), self.gpu.pipeline_cache());
            // SAFETY: all of one live device.
            let made = unsafe { DecidePipeline::new(device.raw(), &self.layout, cache) }?;
            // SAFETY: it was just made by this device. Another worker may have been quicker.
            let _ = self.deciding.set(unsafe { Owned::new(device, made) });
        }
        Ok(())
    }

    /// The shaders that everything is made of.
    pub fn shaders(&self) -> Shaders {
        self.kept().shaders.clone()
    }

    /// Pipelines that have been made.
    pub fn ready(&self, key: &Key) -> Option<Arc<Owned<Pipelines>>> {
        self.kept().find(key)
    }

    /// The same, or others that draw the same patches in another look until these are there.
    pub fn ready_or_like(&self, key: &Key) -> Option<Arc<Owned<Pipelines>>> {
        let kept = self.kept();
        kept.find(key).or_else(|| kept.find_like(key))
    }

    /// Gives up pipelines that have not been drawn with for a while. Not while a frame is drawn.
    pub fn give_up_but(&self, wanted: &[Key]) -> Pipes {
        self.kept().give_up_but(wanted)
    }

    /// Makes pipelines, unless they are there. Takes its time: for workers.
    pub fn make(&self, prepared: &Prepared, style: Style) -> Result<Arc<Owned<Pipelines>>> {
        let key = key(prepared, style);
        if let Some(ready) = self.ready(&key) {
            return Ok(ready);
        }
        let shaders = self.shaders();
        let made = self.make_of(prepared, style, &*shaders.modules)?;
        let mut kept = self.kept();
        // Others may have come meanwhile: then it will be made of those.
        if kept.shaders.version == shaders.version {
            kept.add(key, made.clone());
        }
        Ok(made)
    }

    /// Makes pipelines of other shaders; those that nothing changes of stay what they are. Takes its time: for workers.
    #[cfg(feature = "shaderc")]
    pub fn remake(&self, wanted: &[(Prepared, Style)], from: &dyn Modules) -> Result<Pipes> {
        let of = self.shaders().modules;
        let mut made = Pipes::new();
        for (prepared, style) in wanted {
            let key = key(prepared, *style);
            let names = Pipelines::modules(prepared, &style.options(&self.mould));
            let same = |name: &String| of.fingerprint(name) == from.fingerprint(name);
            let pipelines = match self.ready(&key).filter(|_| names.iter().all(same)) {
                Some(ready) => ready,
                None => self.make_of(prepared, *style, from)?,
            };
            made.push((key, pipelines));
        }
        Ok(made)
    }

    /// Goes over to other shaders, with the pipelines that have been made of them; the old ones come back. Not while a frame is drawn.
    #[cfg(feature = "shaderc")]
    pub fn exchange(&self, modules: Arc<dyn Modules + Send + Sync>, pipelines: Pipes) -> Pipes {
        self.kept().exchange(modules, pipelines)
    }

    fn make_of(
        &self,
        prepared: &Prepared,
        style: Style,
        from: &dyn Modules,
    ) -> Result<Arc<Owned<Pipelines>>> {
        let _span = tracing::debug_span!("pipelines").entered();
        let options = style.options(&self.mould);
        let (device, cache) = (self.device(), self.gpu.pipeline_cache());
        let (raw, layout) = (device.raw(), &self.layout);
        // SAFETY: all of one live device; the modules are ours, or what somebody makes of them to look at.
        let made = unsafe { Pipelines::with_modules(raw, layout, cache, prepared, &options, from) };
        // SAFETY: they were just made by this device.
        Ok(Arc::new(unsafe { Owned::new(device, made?) }))
    }

    /// Writes what pipelines were made of, for the next start: how many there had been. Takes its time: for workers.
    pub fn save_cache(&self) -> u64 {
        let made = self.made();
        // A device that cannot tell has other troubles, of which others tell.
        if let Err(error) = self.gpu.keep_pipelines() {
            tracing::info!("{error}");
        }
        made
    }

    /// How many pipelines were made so far.
    pub fn made(&self) -> u64 {
        self.kept().made()
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What a method made of a model, with what it took.
pub struct Readied {
    made: Made,
    /// Seconds.
    seconds: f64,
    /// Why methods that come before the one that did it refused.
    refusals: Vec<String>,
}

enum Made {
    Plain(Box<Prepared>),
    Editable(Box<Editable>),
}

impl Readied {
    /// Prepares a model as a recipe says. Takes its time, and needs no device: for workers.
    pub fn new(model: &Model, recipe: Recipe, database: &Database) -> Result<Readied> {
        let started = Instant::now();
        let _span = tracing::debug_span!("prepare").entered();
        let (made, refusals) = match recipe.live.then(|| editable(model, recipe, database)) {
            Some(Ok(Some(editable))) => (Made::Editable(Box::new(editable)), Vec::new()),
            // What refuses is told by the one that is not edited.
            _ => {
                let (prepared, refusals) = prepare(model, recipe.method, database)?;
                (Made::Plain(Box::new(prepared)), refusals)
            }
        };
        Ok(Readied {
            made,
            seconds: started.elapsed().as_secs_f64(),
            refusals: refusals.iter().map(ToString::to_string).collect(),
        })
    }
}

/// Prepares a model to be edited in place; None where its method cannot.
fn editable(model: &Model, recipe: Recipe, database: &Database) -> Result<Option<Editable>> {
    let method = match recipe.method {
        Some(name) => method(name)?,
        None => method_by_default(model),
    };
    if !method.edits_in_place() {
        return Ok(None);
    }
    let options = MethodOptions::default();
    method.prepare_editable(model, options, database).map(Some)
}

/// Prepares a model by a method, or by the one that draws its limit or comes near, with the plans of a database; and why those before that one refused.
pub fn prepare(
    model: &Model,
    by: Option<&'static str>,
    database: &Database,
) -> Result<(Prepared, Vec<Error>)> {
    let options = MethodOptions::default();
    match by {
        Some(name) => {
            let prepared = method(name)?.prepare_with(model, options, database)?;
            Ok((prepared, Vec::new()))
        }
        None => prepare_by_default_with(model, options, database),
    }
}

/// A mesh under another scheme, of triangles where that takes them.
pub fn under_scheme(
    mesh: ControlMesh,
    scheme: hullform::mesh::Scheme,
    how: crate::options::Triangulate,
) -> Result<ControlMesh> {
    let polygons = mesh.faces().any(|face| face.len() > 3);
    let mesh = match scheme.is_triangular() && polygons {
        true => hullform::mesh::triangulated(&mesh, how.into())?,
        false => mesh,
    };
    mesh.with_scheme(scheme)
}
