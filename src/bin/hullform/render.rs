//! `hullform render`: a picture of a model.

use crate::camera::{Camera, View};
use crate::gpu::Gpu;
use crate::options::{Cut, Global, Size};
use crate::output::{Format, Pending, png};
use crate::{model, print, progress};
use clap::{Args, ValueEnum};
use hullform::host::OffscreenTarget;
use hullform::mesh::ControlMesh;
use hullform::{Error, Result};
use serde_json::Value;
use std::path::PathBuf;

/// Samples a pixel.
const SAMPLES: u32 = 4;
/// The picture's background, in linear light.
const BACKGROUND: [f32; 4] = [0.02, 0.02, 0.025, 1.0];

/// Options of `render`.
#[derive(Args)]
pub struct Arguments {
    /// OBJ file, or builtin:NAME [default: the first built-in shape]
    model: Option<String>,
    /// Picture to write
    #[arg(short, long, value_name = "FILE.png", default_value = "hullform.png")]
    output: PathBuf,
    #[command(flatten)]
    cut: Cut,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720")]
    size: Size,
    /// What the colours mean
    #[arg(long, default_value = "lit")]
    shading: Shading,
    /// Draw the edges of the triangles only
    #[arg(long)]
    wireframe: bool,
    /// Angles in degrees and a zoom
    #[arg(
        long,
        value_name = "YAW,PITCH,ZOOM",
        default_value = "30,20,1",
        allow_hyphen_values = true
    )]
    camera: Camera,
    /// Write statistics of the drawing as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
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
}

/// Everything to be drawn.
struct Scene<'a> {
    mesh: &'a ControlMesh,
    cut: &'a Cut,
    view: View,
    shading: Shading,
    wireframe: bool,
    ring_bytes: u64,
}

/// Draws the model and writes picture and statistics.
///
/// The files come last: what the validation layer complained about is not written.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    Format::of(&arguments.output, &[Format::Png])?;
    let mesh = model::load(arguments.model.as_deref())?;
    let picture = Pending::create(&arguments.output)?;
    let stats_file = arguments.stats.as_deref().map(Pending::create);
    let stats_file = stats_file.transpose()?;
    let gpu = Gpu::open(global)?;
    let (pixels, stats) = draw_picture(&gpu, &mesh, arguments, global)?;
    gpu.finish()?;
    let size = arguments.size;
    picture.write(|file| png::write(file, size.width, size.height, &pixels))?;
    if let Some(file) = stats_file {
        file.write(|file| writeln!(file, "{stats:#}"))?;
    }
    report(arguments, global, &stats)
}

fn draw_picture(
    gpu: &Gpu,
    mesh: &ControlMesh,
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
    let target = OffscreenTarget::new(&gpu.device, width, height, SAMPLES)?;
    let aspect = width as f32 / height as f32;
    let scene = Scene {
        mesh,
        cut: &arguments.cut,
        view: arguments.camera.frame(mesh.bounds(), aspect),
        shading: arguments.shading,
        wireframe: arguments.wireframe,
        ring_bytes: global.ring_bytes,
    };
    let stats = progress::during("drawing", |_| draw(gpu, &target, &scene))?;
    Ok((target.read_pixels(), stats))
}

fn report(arguments: &Arguments, global: &Global, stats: &Value) -> Result<()> {
    if global.json {
        print(&format!("{stats:#}"))
    } else {
        tracing::info!("wrote {}", arguments.output.display());
        Ok(())
    }
}

/// Draws `scene` into `target`, copies the picture to the host, and returns the statistics.
fn draw(gpu: &Gpu, target: &OffscreenTarget, scene: &Scene<'_>) -> Result<Value> {
    // SEAM: the renderer goes here. Until then there is nothing but the background, and that is not a picture of the model.
    let _ = (scene.mesh, scene.cut, scene.view.clip_from_model());
    let _ = (scene.shading, scene.wireframe, scene.ring_bytes);
    let _ = &gpu.workarounds;
    gpu.device.submit(|cmd| {
        // SAFETY: a pass of this device's target, and then the copy of its picture.
        unsafe {
            target.begin(cmd, BACKGROUND);
            target.end(cmd);
            target.cmd_copy_to_host(cmd);
        }
        Ok(())
    })?;
    Err(Error::Refused("drawing is not built yet".into()))
}
