//! `hullform render`: a picture of a model.

mod shading;
mod statistics;

pub use shading::Shading;

use crate::adaptive::Seen;
use crate::camera::{Camera, View};
use crate::deciding::Wanted;
use crate::drawing::{self, Drawing};
use crate::eye::{Eye, Sphere};
use crate::framing::{Framed, Subject};
use crate::gpu::Gpu;
use crate::options::{self, Chosen, Cutting, Global, Size};
use crate::output::{self, Contents, Format, picture, png, wrote};
use crate::{model, print, print_json, progress};
use clap::Args;
use hullform::ash::vk;
use hullform::gpu::{self, Decides, Decision, DrawList, Fill, Residence, Slots, SurfaceOptions};
use hullform::host::{Area, Bench, Encoding, OffscreenTarget, Shot, Style};
use hullform::mesh::Model;
use hullform::method::{Displacement, Outline, Prepared};
use hullform::{Error, Result};
use serde_json::Value;
use std::path::PathBuf;
use std::time::Instant;

/// Samples a pixel.
const SAMPLES: u32 = 4;
/// Pixels are drawn as squares of so many, where the device's limits allow, and averaged.
pub const SUPERSAMPLING: u32 = 2;
/// Nothing: the background comes when the picture is composed.
pub const CLEAR: [f32; 4] = [0.0; 4];

/// Options of `render`.
#[derive(Args)]
pub struct Arguments {
    /// OBJ file, or builtin:NAME [default: the first built-in shape]
    pub model: Option<PathBuf>,
    /// Picture to write
    #[arg(short, long, value_name = "FILE.png", default_value = "hullform.png")]
    output: PathBuf,
    #[command(flatten)]
    shape: options::Shape,
    #[command(flatten)]
    cut: options::Cut,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720")]
    size: Size,
    /// What the colours mean
    #[arg(long, default_value = "lit")]
    shading: Shading,
    /// Draw the edges of the triangles over the surface
    #[arg(long)]
    wireframe: bool,
    #[command(flatten)]
    sight: options::Sight,
    #[command(flatten)]
    standpoint: options::Standpoint,
    /// Leave out what is not seen, one or several: `frustum` patches outside of the picture, `back` triangles that are seen from behind and patches
    /// that show nothing else, `small` patches between samples, `all` of these; `front` triangles that are seen from the front; or `none`
    #[arg(long, value_name = "A,B,...", default_value = "none")]
    cull: options::Culling,
    /// Move each vertex whose position has an odd number of bits: where faces differ on an edge, a hole opens
    #[arg(long)]
    amplify_cracks: bool,
    /// Displace the surface along its normal by bumps of this height, as a share of the model's diagonal
    #[arg(long, value_name = "AMOUNT", default_value = "0", value_parser = options::share, allow_hyphen_values = true)]
    displace: f32,
    /// Write statistics of the drawing as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
}

#[cfg(feature = "view")]
impl Arguments {
    /// The size of the picture.
    pub fn size(&self) -> Size {
        self.size
    }

    /// What is decided about patches.
    #[cfg(test)]
    pub fn wanted(&self) -> Wanted {
        Wanted {
            adaptive: self.cut.cutting().adaptive,
            culling: self.cull,
        }
    }

    /// The eye that was chosen.
    #[cfg(test)]
    pub fn eye(&self) -> Option<Eye> {
        self.standpoint.eye()
    }
}

/// Everything to be drawn.
struct Scene<'a> {
    model: &'a Model,
    chosen: Chosen,
    cutting: Cutting,
    sight: Sight,
    shading: Shading,
    displacement: Displacement,
    wireframe: bool,
    culling: options::Culling,
    amplify_cracks: bool,
    ring_bytes: u64,
    slots: Slots,
    points: options::Points,
    /// Pixels are drawn as squares of so many.
    factor: u32,
    load_seconds: f64,
}

/// Where a scene is seen from.
enum Sight {
    /// From where the camera sees all of the surface, in a picture of this size.
    Framed(Camera, Size),
    /// From where somebody chose to look, in a picture of this size.
    Chosen(Eye, Size),
    /// From a given place, in this part of the picture; depth tags are not asked for.
    Given(View, Area),
}

/// Draws the model and writes picture and statistics.
///
/// The files come last: what the validation layer complained about is not written.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    Format::of(&arguments.output, &[Format::Png])?;
    let started = Instant::now();
    let mesh = model::load(arguments.model.as_deref(), &arguments.shape)?;
    arguments.cut.check(mesh.options().scheme)?;
    let model = Model::new(mesh);
    arguments.cut.chosen(&model)?;
    let load_seconds = started.elapsed().as_secs_f64();
    let reads = model::file(arguments.model.as_deref());
    let mut writes = vec![("--output", arguments.output.as_path())];
    writes.extend(arguments.stats.as_deref().map(|path| ("--stats", path)));
    let files = output::create(reads.as_slice(), &writes)?;
    let gpu = Gpu::open(global)?;
    let (pixels, stats) = draw_picture(&gpu, &model, load_seconds, arguments, global)?;
    gpu.finish()?;
    let size = arguments.size;
    // Picture and statistics, in the order of `writes`.
    let contents: [&Contents; 2] = [
        &|out| png::write(out, size.width, size.height, &pixels),
        &|out| writeln!(out, "{stats:#}"),
    ];
    output::write(files.into_iter().zip(contents))?;
    report(arguments, global, &stats)
}

/// Draws a model as the arguments have it, whatever model they name: RGBA, and the statistics.
pub fn draw_picture(
    gpu: &Gpu,
    model: &Model,
    load_seconds: f64,
    arguments: &Arguments,
    global: &Global,
) -> Result<(Vec<u8>, Value)> {
    let Size { width, height } = arguments.size;
    if arguments.wireframe && !gpu.device.info().support.optional.fill_mode_non_solid {
        return Err(Error::Option {
            option: "--wireframe",
            problem: format!("{} draws no wireframes", gpu.device.info().name),
            remedy: "choose another device or leave it out".into(),
        });
    }
    check_culling(gpu, arguments)?;
    let (mut bench, factor) = bench(gpu, width, height)?;
    let scene = Scene {
        model,
        chosen: arguments.cut.chosen(model)?,
        cutting: arguments.cut.cutting(),
        sight: match arguments.standpoint.eye() {
            Some(eye) => Sight::Chosen(eye, arguments.size),
            None => Sight::Framed(arguments.sight.camera, arguments.size),
        },
        shading: arguments.shading,
        displacement: bumps(model, arguments.displace),
        wireframe: arguments.wireframe,
        culling: arguments.cull,
        amplify_cracks: arguments.amplify_cracks,
        ring_bytes: global.ring_bytes,
        slots: drawing::slots(global.slots),
        points: global.points,
        factor,
        load_seconds,
    };
    let stats = progress::during("drawing", |_| draw(gpu, &mut bench, &scene))?;
    let (pixels, area) = (bench.target().read_pixels(), bench.target().area());
    Ok((picture::compose(pixels, area, width, height, factor), stats))
}

/// # Errors
/// [`Error::Option`] for patches that are left out where they might be seen.
fn check_culling(gpu: &Gpu, arguments: &Arguments) -> Result<()> {
    let culling = arguments.cull;
    let standard = gpu.device.limits().standard_sample_locations != 0;
    let (problem, remedy) = match () {
        () if culling.small && arguments.wireframe => (
            "lines are wider than what is between samples",
            "leave out small, or --wireframe",
        ),
        () if culling.small && !standard => (
            "the device has its samples in places of its own",
            "leave out small, or choose another device",
        ),
        () if culling.needs_decisions() && arguments.amplify_cracks => (
            "vertices that are moved may come into the picture",
            "leave out frustum and small, or --amplify-cracks",
        ),
        () => return Ok(()),
    };
    Err(Error::Option {
        option: "--cull",
        problem: problem.into(),
        remedy: remedy.into(),
    })
}

/// A bench for a picture, and the factor by which its target is larger.
pub fn bench(gpu: &Gpu, width: u32, height: u32) -> Result<(Bench, u32)> {
    let limits = gpu.device.limits();
    let widest = limits
        .max_framebuffer_width
        .min(limits.max_framebuffer_height);
    let factor = if width.max(height) <= widest / SUPERSAMPLING {
        SUPERSAMPLING
    } else {
        1
    };
    let size = [width * factor, height * factor];
    // Until it is known where something is to be seen.
    let pixel = Area {
        x: 0,
        y: 0,
        width: 1,
        height: 1,
    };
    let format = Encoding::default().format();
    let target = OffscreenTarget::cropped(&gpu.device, size, pixel, SAMPLES, format)?;
    Ok((gpu.bench(target)?, factor))
}

/// Draws a model lit, by a method, as seen in `view`: in an area of the picture, whose pixels are drawn as squares of `factor`.
#[allow(clippy::too_many_arguments)]
pub fn draw_lit(
    gpu: &Gpu,
    (bench, factor): (&mut Bench, u32),
    model: &Model,
    chosen: Chosen,
    cutting: Cutting,
    (view, area): (View, Area),
    global: &Global,
) -> Result<()> {
    let scene = Scene {
        model,
        chosen,
        cutting,
        sight: Sight::Given(view, area),
        shading: Shading::Lit,
        displacement: Displacement::default(),
        wireframe: false,
        culling: options::Culling::default(),
        amplify_cracks: false,
        ring_bytes: global.ring_bytes,
        slots: drawing::slots(global.slots),
        points: global.points,
        factor,
        load_seconds: 0.0,
    };
    draw(gpu, bench, &scene).map(drop)
}

fn report(arguments: &Arguments, global: &Global, stats: &Value) -> Result<()> {
    if global.prints_json() {
        print_json(stats)
    } else {
        print(&wrote(&arguments.output))
    }
}

/// Draws `scene` into the target of `bench`, copies the picture to the host, and returns the statistics.
fn draw(gpu: &Gpu, bench: &mut Bench, scene: &Scene<'_>) -> Result<Value> {
    let started = Instant::now();
    let prepared = drawing::prepare(scene.model, scene.chosen)?;
    let plan_seconds = started.elapsed().as_secs_f64();
    let seen = scene.seen(gpu, bench, &prepared)?;
    let Area {
        x,
        y,
        width,
        height,
    } = seen.area;
    let factor = scene.factor;
    bench.target_mut().crop(Area {
        x: x * factor,
        y: y * factor,
        width: width * factor,
        height: height * factor,
    })?;
    let draw = |prepared, again| draw_with(gpu, bench, scene, prepared, plan_seconds, &seen, again);
    let stats = draw(prepared, false)?;
    if stats["ring"]["overflows"] == 0 {
        return Ok(stats);
    }
    // Control shaders ran more often than once a patch and took more than their share.
    tracing::warn!("the scratch ring overflowed; drawing again without slots by counters");
    draw(drawing::prepare(scene.model, scene.chosen)?, true)
}

impl Scene<'_> {
    /// What is seen of it, and the depth tags that the cutting asks for.
    fn seen(&self, gpu: &Gpu, bench: &Bench, prepared: &Prepared) -> Result<Framed> {
        match self.sight {
            Sight::Given(view, area) => Ok(Framed {
                view,
                tags: None,
                area,
            }),
            Sight::Chosen(eye, Size { width, height }) => {
                let all = self.sphere();
                let aspect = f64::from(width) / f64::from(height);
                let view = eye.view(self.model.placement(), aspect, all);
                let size = [width, height].map(|side| side as f32);
                let cutting = self.cutting;
                let tags = drawing::tags_for(self.model, prepared, cutting, &view, size)?;
                let area = Area {
                    x: 0,
                    y: 0,
                    width,
                    height,
                };
                Ok(Framed { view, tags, area })
            }
            Sight::Framed(camera, Size { width, height }) => {
                let subject = Subject {
                    gpu,
                    bench,
                    fill: self.solid(),
                    model: self.model,
                    prepared,
                    cutting: self.cutting,
                    displacement: self.displacement,
                    ring_bytes: self.ring_bytes,
                    points: self.points,
                };
                subject.framed(camera, [width, height])
            }
        }
    }

    /// A sphere around all of it, bumps included.
    fn sphere(&self) -> Sphere {
        let mut all = Sphere::around(self.model.mesh().positions().iter().copied());
        let height = f64::from(self.displacement.height.abs()) * self.model.placement().scale;
        all.radius += height;
        all
    }

    /// What the device decides by, where it does.
    fn decision(&self, by: (&Bench, &Outline), wanted: Wanted, view: &View) -> Result<Decision> {
        let (bench, outline) = by;
        let vk::Extent2D { width, height } = bench.target().extent();
        let seen = Seen {
            clip_from_model: view.clip_from_model,
            eye: view.eye,
            scale: self.model.placement().scale,
            size: [width, height].map(|side| side as f32),
        };
        // In pixels that are drawn.
        let wanted = wanted.scaled(self.factor as f32);
        let culled = wanted.decision(outline, &self.model.positions(), seen, SAMPLES)?;
        Ok(Decision {
            // Vertices that are moved may turn triangles.
            back: culled.back && !self.amplify_cracks,
            ..culled
        })
    }

    /// What becomes of its triangles.
    fn solid(&self) -> Fill {
        Fill::Solid(self.shading.into())
    }
}

fn draw_with(
    gpu: &Gpu,
    bench: &Bench,
    scene: &Scene<'_>,
    prepared: Prepared,
    plan_seconds: f64,
    Framed { view, tags, .. }: &Framed,
    again: bool,
) -> Result<Value> {
    let Cutting {
        cut,
        backend,
        residence,
        adaptive,
    } = scene.cutting;
    let wanted = Wanted {
        adaptive,
        culling: scene.culling,
    };
    let decides = wanted.decides((backend, prepared.is_dynamic()), scene.slots, cut.level)?;
    // Slots from the host do not depend on who runs how often, and a cache has none.
    let (slots, residence) = match decides {
        Decides::Host if again => (Slots::Host, residence),
        Decides::Device if again => (scene.slots, Residence::Cache),
        _ => (scene.slots, residence),
    };
    let rounds = if scene.wireframe { 2 } else { 1 };
    let options = SurfaceOptions {
        backend,
        residence,
        ring_bytes: scene.ring_bytes,
        slots,
        decides,
        count_vertices: decides == Decides::Host,
        greatest_level: cut.level,
        rounds,
        views: rounds,
        amplify_cracks: scene.amplify_cracks,
        ..Default::default()
    };
    let mut drawing = Drawing::new(gpu, bench, scene.model, prepared, options, scene.points)?;
    match decides {
        Decides::Host => drawing.tags = tags.clone(),
        Decides::Device => {
            let by = (bench, &drawing.prepared().outline);
            drawing.decision = scene.decision(by, wanted, view)?;
        }
    }
    let list = drawing.draw_list(cut)?;
    let started = Instant::now();
    let mut fills = vec![scene.solid()];
    fills.extend(scene.wireframe.then_some(Fill::Lines));
    let pipelines = fills.into_iter().map(|fill| {
        let style = Style {
            cull: scene.culling.triangles.mode(),
            ..Style::new(options, cut.spacing, fill)
        };
        bench.pipelines(drawing.prepared(), style)
    });
    let pipelines = pipelines.collect::<Result<Vec<_>>>()?;
    let shots = (0..).zip(&pipelines).map(|(round, pipelines)| {
        Ok(Shot {
            pipelines,
            view: library_view(view, scene),
            instances: 1,
            batches: list.round(round)?.collect(),
        })
    });
    let counted = drawing.draw(&shots.collect::<Result<Vec<_>>>()?)?;
    let first_frame = started.elapsed().as_secs_f64();
    // Patches without room in the ring are known to be missing: see `draw`.
    if drawing.surface().counters()?.overflows == 0 {
        let drawn = (0..pipelines.len()).flat_map(|_| list.batches());
        match decides {
            Decides::Host => drawing.surface().arrival(drawn)?.check()?,
            Decides::Device => check_arrival(&drawing, &list, counted)?,
        }
    }
    let seconds = [plan_seconds, first_frame];
    statistics::of(gpu, scene, &drawing, &list, counted, seconds)
}

/// Refuses a picture of which the device lost something, where it counts what it evaluates. The first round counts.
fn check_arrival(drawing: &Drawing<'_>, list: &DrawList, counted: Option<[u64; 3]>) -> Result<()> {
    let predicted = drawing.surface().outcome(list, 0..1)?.vertices;
    match counted {
        Some([_, came, _]) if came < predicted => Err(Error::Lost {
            what: format!("{} of {predicted} vertices", predicted - came),
        }),
        _ => Ok(()),
    }
}

/// The view as the library takes it.
fn library_view(view: &View, scene: &Scene<'_>) -> gpu::View {
    gpu::View {
        clip_from_model: view.clip_from_model.to_cols_array_2d(),
        eye: view.eye.to_array(),
        displacement: scene.displacement,
    }
}

/// Bumps as high as a share of the model's diagonal, a few dozen of them along it.
pub fn bumps(model: &Model, share: f32) -> Displacement {
    let diagonal = model.diagonal() as f32;
    Displacement {
        height: share * diagonal,
        frequency: 30.0 / diagonal.max(f32::MIN_POSITIVE),
    }
}
