//! `hullform render`: a picture of a model.

use crate::camera::{Camera, View};
use crate::drawing::{self, Drawing};
use crate::eye::{Eye, Sphere};
use crate::framing::{Framed, Subject};
use crate::gpu::Gpu;
use crate::options::{self, Chosen, Cutting, Global, Size};
use crate::output::{self, Contents, Format, picture, png, wrote};
use crate::{model, print, print_json, progress};
use clap::{Args, ValueEnum};
use hullform::gpu::{self, DrawList, Fill, Slots, SurfaceOptions};
use hullform::host::{Area, Bench, Encoding, OffscreenTarget, Shot, Style};
use hullform::mesh::Model;
use hullform::method::{Displacement, Prepared};
use hullform::{Error, Result};
use serde_json::{Value, json};
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
    /// Leave out triangles that are seen from behind, or from the front
    #[arg(long, value_name = "WHICH", default_value = "none")]
    cull: options::Cull,
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

    /// The eye that was chosen.
    #[cfg(test)]
    pub fn eye(&self) -> Option<Eye> {
        self.standpoint.eye()
    }
}

/// What the colours of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Shading {
    /// A lit surface
    Lit,
    /// The normal's direction
    Normal,
    /// A colour for each patch
    Patch,
    /// The kind of node that a point was evaluated in
    Node,
    /// The valences of the face's vertices
    Valence,
    /// The tess levels of patches and their edges
    Level,
    /// Squares of texture coordinates, eight a unit
    Checker,
    /// How deep in the quadtree a point was evaluated
    Depth,
    /// The height of the displacement
    Height,
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
    cull: options::Cull,
    amplify_cracks: bool,
    ring_bytes: u64,
    slots: Slots,
    points: options::Points,
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
        cull: arguments.cull,
        amplify_cracks: arguments.amplify_cracks,
        ring_bytes: global.ring_bytes,
        slots: drawing::slots(global.slots),
        points: global.points,
        load_seconds,
    };
    let stats = progress::during("drawing", |_| draw(gpu, &mut bench, factor, &scene))?;
    let (pixels, area) = (bench.target().read_pixels(), bench.target().area());
    Ok((picture::compose(pixels, area, width, height, factor), stats))
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
        cull: options::Cull::None,
        amplify_cracks: false,
        ring_bytes: global.ring_bytes,
        slots: drawing::slots(global.slots),
        points: global.points,
        load_seconds: 0.0,
    };
    draw(gpu, bench, factor, &scene).map(drop)
}

fn report(arguments: &Arguments, global: &Global, stats: &Value) -> Result<()> {
    if global.prints_json() {
        print_json(stats)
    } else {
        print(&wrote(&arguments.output))
    }
}

/// Draws `scene` into the target of `bench`, copies the picture to the host, and returns the statistics.
fn draw(gpu: &Gpu, bench: &mut Bench, factor: u32, scene: &Scene<'_>) -> Result<Value> {
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
    bench.target_mut().crop(Area {
        x: x * factor,
        y: y * factor,
        width: width * factor,
        height: height * factor,
    })?;
    let draw = |prepared, slots| draw_with(gpu, bench, scene, prepared, plan_seconds, &seen, slots);
    let stats = draw(prepared, scene.slots)?;
    if stats["ring"]["overflows"] == 0 {
        return Ok(stats);
    }
    // Control shaders ran more often than once a patch and took more than their share. Slots from the host do not depend on that.
    tracing::warn!("the scratch ring overflowed; drawing again with slots from the host");
    draw(drawing::prepare(scene.model, scene.chosen)?, Slots::Host)
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
    slots: Slots,
) -> Result<Value> {
    let Cutting {
        cut,
        backend,
        residence,
        ..
    } = scene.cutting;
    let options = SurfaceOptions {
        backend,
        residence,
        ring_bytes: scene.ring_bytes,
        slots,
        count_vertices: true,
        greatest_level: cut.level,
        rounds: if scene.wireframe { 2 } else { 1 },
        amplify_cracks: scene.amplify_cracks,
        ..Default::default()
    };
    let mut drawing = Drawing::new(gpu, bench, scene.model, prepared, options, scene.points)?;
    drawing.tags = tags.clone();
    let list = drawing.draw_list(cut)?;
    let started = Instant::now();
    let mut fills = vec![scene.solid()];
    fills.extend(scene.wireframe.then_some(Fill::Lines));
    let pipelines = fills.into_iter().map(|fill| {
        let style = Style {
            cull: scene.cull.mode(),
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
        drawing.surface().arrival(drawn)?.check()?;
    }
    let seconds = [plan_seconds, first_frame];
    statistics(gpu, scene, &drawing, &list, &counted, seconds)
}

/// What `--stats` writes.
fn statistics(
    gpu: &Gpu,
    scene: &Scene<'_>,
    drawing: &Drawing<'_>,
    list: &DrawList,
    counted: &Option<[u64; 3]>,
    [plan_seconds, first_frame]: [f64; 2],
) -> Result<Value> {
    let info = gpu.device.info();
    let plans = drawing.prepared().plans.clone().unwrap_or_default();
    let patches: usize = drawing
        .prepared()
        .passes
        .iter()
        .map(|pass| pass.patches.len())
        .sum();
    let ring_batches = list.batches().filter(|batch| batch.points() > 0).count();
    let counters = drawing.surface().counters()?;
    Ok(json!({
        "device": info.name,
        "driver": format!("{} {}", info.driver.name, info.driver.info),
        "method": drawing.prepared().method,
        "level": scene.cutting.cut.level,
        "backend": scene.cutting.backend.name(),
        "residence": scene.cutting.residence.name(),
        "spacing": scene.cutting.cut.spacing.name(),
        "patches": { "total": patches, "regular": plans.regular, "irregular": plans.irregular },
        "plans": plans.plans,
        "draws": list.batches().map(|batch| batch.draws().len()).sum::<usize>(),
        "batches": ring_batches,
        "workarounds": gpu.workarounds.iter().map(|row| row.name).collect::<Vec<_>>(),
        "pipeline_statistics": counted.map(|[patches, evaluations, clipping]| json!({
            "control_shader_patches": patches,
            "evaluation_invocations": evaluations,
            "clipping_primitives": clipping,
        })),
        "ring": {
            "bytes": scene.ring_bytes,
            "points_computed": counters.points,
            "overflows": counters.overflows,
        },
        "seconds": {
            "load": scene.load_seconds,
            "plan": plan_seconds,
            "upload": drawing.upload_seconds,
            "first_frame": first_frame,
        },
    }))
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

impl From<Shading> for gpu::Shading {
    fn from(shading: Shading) -> gpu::Shading {
        match shading {
            Shading::Lit => gpu::Shading::Lit,
            Shading::Normal => gpu::Shading::Normal,
            Shading::Patch => gpu::Shading::Patch,
            Shading::Node => gpu::Shading::Node,
            Shading::Valence => gpu::Shading::Valence,
            Shading::Level => gpu::Shading::Level,
            Shading::Checker => gpu::Shading::Checker,
            Shading::Depth => gpu::Shading::Depth,
            Shading::Height => gpu::Shading::Height,
        }
    }
}
