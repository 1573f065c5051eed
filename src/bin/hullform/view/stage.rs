//! What is on the device of the scene, and how a frame draws it.

mod amends;
mod drawn;
mod levels;
mod scene;

use std::sync::Arc;

use glam::{DVec3, Vec3};
use hullform::Result;
use hullform::ash::vk;
use hullform::gpu::{self, Cut, DrawList, Fill, SurfaceOptions, View};
use hullform::host::{ColouredTriangles, ColouredVertex, Style, TimestampQuery};
use hullform::mesh::Model;
use hullform::method::{Displacement, Prepared};

use super::context::{Context, Drawn, Key};
use super::live::{Followed, Live};
use super::overlay::Overlay;
use super::part::{Part, Wanted};
use super::viewer::{Beside, Viewer};
use super::viewport::Area;
use crate::adaptive::Adaptive;
use crate::eye::{Eye, Sphere};
use crate::render;
use amends::Amends;
use scene::Scene;

/// A part on the device.
pub struct Staged {
    /// Of which part.
    pub number: u64,
    /// The model.
    pub model: Arc<Model>,
    /// What it was made for.
    pub wanted: Wanted,
    /// A surface a recipe.
    pub sides: Vec<Drawn>,
    /// By what it is edited in place; None where it is not, and while a worker has it.
    pub live: Option<Live>,
    /// Which of the part's moves its surfaces have.
    moves: u64,
    /// Where its vertices are on the device, in local units.
    placed: Vec<Vec3>,
    /// What has changed since it was drawn last.
    amends: Amends,
    /// For what the lists were decided.
    decided: Option<Decision>,
}

/// A part as workers bring it to the device.
pub struct Built {
    /// The model.
    pub model: Arc<Model>,
    /// A surface a recipe.
    pub sides: Vec<Drawn>,
    /// By what it is edited in place, where it is.
    pub live: Option<Live>,
}

/// What lists depend on.
#[derive(Clone, Debug, PartialEq)]
struct Decision {
    cut: Cut,
    tags: Option<(super::orbit::Orbit, Adaptive, u64, [u32; 2])>,
}

/// A side of the picture: where it is, and what is drawn there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// What the whole of its view would fill.
    pub viewport: Area,
    /// What is seen of that.
    pub scissor: Area,
    /// Which of the recipes is drawn.
    pub recipe: usize,
}

/// What is on the device.
pub struct Stage {
    /// The parts.
    pub parts: Vec<Staged>,
    overlay: ColouredTriangles,
    maps: Vec<ColouredTriangles>,
    timer: Option<TimestampQuery>,
    timed: bool,
    /// How many vertices the maps and the lines over all have.
    flat: [usize; 3],
    /// Of which parts the maps are, by side.
    mapped: Vec<(usize, u64)>,
    /// What is being drawn, until it is whole.
    scene: Option<Scene>,
    /// At which level the picture is that is whole, and in which sphere all was; None where none is.
    shown: Option<(f32, Sphere)>,
}

/// What a frame took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cost {
    /// Seconds to decide and record.
    pub host: f64,
    /// Draws.
    pub draws: usize,
    /// Batches.
    pub batches: usize,
    /// Vertices that are evaluated.
    pub vertices: u64,
    /// Control points that were computed anew for the cache.
    pub points: u64,
}

impl Staged {
    /// A part that has been brought to the device, as it was when it was read.
    pub fn new(number: u64, wanted: Wanted, built: Built) -> Staged {
        let Built { model, sides, live } = built;
        Staged {
            number,
            placed: model.positions(),
            amends: Amends::default(),
            model,
            wanted,
            sides,
            live,
            moves: 0,
            decided: None,
        }
    }

    /// Brings its surfaces up to an edit: the next frame draws that. Nothing is drawn at this time.
    pub fn edit(&mut self, live: Live, followed: &Followed, context: &Context) -> Result<()> {
        let sides = self.sides.iter_mut().zip(&followed.updates);
        for (number, (drawn, update)) in sides.enumerate() {
            let (amends, placed) = (&mut self.amends, &self.placed);
            amends.add_patches(drawn, update, placed);
            drawn.edit(live.side(number), update, context)?;
            amends.add_patches(drawn, update, placed);
        }
        self.amends.add_lines(&followed.vertices, &self.placed);
        self.decided = None;
        self.live = Some(live);
        Ok(())
    }

    /// The vertices that a side is drawn with.
    pub fn vertices(&self, side: usize) -> u64 {
        self.sides.get(side).map_or(0, |drawn| drawn.vertices)
    }
}

impl Stage {
    /// Nothing is on the device yet.
    pub fn new(context: &Context) -> Result<Stage> {
        let (device, mould) = (context.device(), context.mould());
        let map = || ColouredTriangles::new(device, mould, &[], &[]);
        Ok(Stage {
            parts: Vec::new(),
            overlay: map()?,
            maps: vec![map()?, map()?],
            timer: TimestampQuery::new(device)?,
            timed: false,
            flat: [0; 3],
            mapped: Vec::new(),
            scene: None,
            shown: None,
        })
    }

    /// What the device decided for the scene that was drawn last, once it is done; None where the host decides.
    pub fn outcome(&self) -> Option<gpu::Outcome> {
        let mut sum = None;
        for drawn in self.parts.iter().flat_map(|part| &part.sides) {
            // What has not been drawn yet has not been decided about.
            let list = drawn.list.as_ref().filter(|_| drawn.is_decided_there())?;
            *sum.get_or_insert_default() += drawn.surface.outcome(list, 0..1).ok()?;
        }
        sum
    }

    /// The device's seconds for what was drawn last of a scene. Once it is done.
    pub fn device_seconds(&mut self) -> Option<f64> {
        let timed = std::mem::take(&mut self.timed);
        let timer = self.timer.as_ref().filter(|_| timed)?;
        timer.read().ok()
    }

    /// The sides of the picture.
    pub fn sides(viewer: &Viewer) -> Vec<Side> {
        let (all, at) = (viewer.area, viewer.compare.at);
        let side = |viewport, scissor, recipe| Side {
            viewport,
            scissor,
            recipe,
        };
        match viewer.compare.beside {
            Beside::Alone => vec![side(all, all, 0)],
            Beside::Split => vec![
                side(all, all.columns(0.0, at), 0),
                side(all, all.columns(at, 1.0), 1),
            ],
            Beside::SideBySide => [0, 1]
                .map(|recipe| {
                    let half = all.columns(0.5 * recipe as f64, 0.5 * (recipe + 1) as f64);
                    side(half, half, recipe)
                })
                .into(),
        }
    }

    /// What becomes of triangles, in the order in which they are drawn.
    pub fn fills(viewer: &Viewer) -> Vec<Fill> {
        let mut fills = vec![Fill::Solid(viewer.look.shading.into())];
        fills.extend(viewer.look.wireframe.then_some(Fill::Lines));
        fills
    }

    /// Takes a part in; what there was of it comes back.
    pub fn put(&mut self, staged: Staged) -> Vec<Staged> {
        let same = |other: &mut Staged| other.number == staged.number;
        self.abandon();
        let old = self.parts.extract_if(.., same).collect();
        self.parts.push(staged);
        self.parts.sort_by_key(|staged| staged.number);
        old
    }

    /// Keeps these parts alone; the others come back.
    pub fn keep(&mut self, numbers: &[u64]) -> Vec<Staged> {
        let gone = |staged: &mut Staged| !numbers.contains(&staged.number);
        let gone: Vec<Staged> = self.parts.extract_if(.., gone).collect();
        if !gone.is_empty() {
            self.abandon();
        }
        gone
    }

    /// What pipelines must be for to draw everything.
    pub fn keys(&self, viewer: &Viewer) -> Vec<Key> {
        let drawn = self.parts.iter().flat_map(|part| &part.sides);
        let keys = drawn.flat_map(|drawn| {
            let fills = Stage::fills(viewer).into_iter();
            fills.map(|fill| drawn.key(style(drawn, viewer, fill)))
        });
        keys.collect()
    }

    /// Pipelines that are needed and not there, each with a part and a side that they are for.
    pub fn missing(&self, viewer: &Viewer, context: &Context) -> Vec<(usize, usize, Style)> {
        let mut missing: Vec<(Key, (usize, usize, Style))> = Vec::new();
        for (number, part) in self.parts.iter().enumerate() {
            for (side, drawn) in part.sides.iter().enumerate() {
                for fill in Stage::fills(viewer) {
                    let style = style(drawn, viewer, fill);
                    let key = drawn.key(style);
                    let known = missing.iter().any(|(other, _)| *other == key);
                    if !known && context.ready(&key).is_none() {
                        missing.push((key, (number, side, style)));
                    }
                }
            }
        }
        missing.into_iter().map(|(_, place)| place).collect()
    }

    /// Whether something cannot be drawn, not even in another look, before pipelines that are being made are there.
    pub fn waits(&self, viewer: &Viewer, context: &Context, made: impl Fn(&Key) -> bool) -> bool {
        let mut all = self.parts.iter().flat_map(|part| &part.sides);
        all.any(|drawn| {
            let keys = Stage::fills(viewer).into_iter();
            let mut keys = keys.map(|fill| drawn.key(style(drawn, viewer, fill)));
            keys.any(|key| made(&key) && context.ready_or_like(&key).is_none())
        })
    }

    /// Brings what has changed to where the next frame finds it: places, levels, lines. Nothing is drawn at this time.
    ///
    /// # Errors
    /// What the library refuses, of a part whose number comes along.
    pub fn decide(
        &mut self,
        viewer: &Viewer,
        cut: Cut,
        overlay: &Overlay,
        context: &Context,
    ) -> Result<()> {
        for staged in &mut self.parts {
            let number = staged.number;
            let Some(part) = viewer.parts.iter().find(|part| part.number() == number) else {
                continue;
            };
            staged.place(part)?;
            staged.decide(viewer, cut, part, context)?;
        }
        let map = |side: usize| overlay.maps.get(side).map_or(0, |map| map.0.len());
        self.mapped.clone_from(&overlay.mapped);
        self.flat = [map(0), map(1), overlay.vertices.len()];
        let maps = self.maps.iter_mut().zip(&overlay.maps);
        // SAFETY: nothing is drawn at this time, which the caller has asked the canvas.
        unsafe {
            for (map, (vertices, triangles)) in maps {
                map.replace(vertices, triangles)?;
            }
            self.overlay.replace(&overlay.vertices, &overlay.triangles)
        }
    }
}

/// How surfaces are drawn.
pub fn style(drawn: &Drawn, viewer: &Viewer, fill: Fill) -> Style {
    style_of(drawn.surface.options(), viewer, fill)
}

/// The same of surfaces that are not there yet. Wires are as thin as in `render`'s pictures.
pub fn style_of(options: SurfaceOptions, viewer: &Viewer, fill: Fill) -> Style {
    Style {
        cull: viewer.cutting.culling.triangles.mode(),
        line_width: viewer.scale / render::SUPERSAMPLING as f32,
        ..Style::new(options, viewer.cutting.spacing, fill)
    }
}

/// What an eye sees of a model.
fn view(viewer: &Viewer, eye: Eye, model: &Model, area: Area) -> View {
    let placement = model.placement();
    let seen = eye.view(placement, area.aspect(), viewer.sphere());
    View {
        clip_from_model: seen.clip_from_model.to_cols_array_2d(),
        eye: seen.eye.to_array(),
        displacement: displacement(viewer, model),
    }
}

/// Bumps as `render` has them.
fn displacement(viewer: &Viewer, model: &Model) -> Displacement {
    render::bumps(model, viewer.look.displace)
}

/// # Safety
/// `cmd` is recording on `device`.
unsafe fn cmd_look(device: &hullform::ash::Device, cmd: vk::CommandBuffer, side: &Side) {
    let (port, part) = (side.viewport, side.scissor);
    let viewport = vk::Viewport {
        x: port.x as f32,
        y: port.y as f32,
        width: port.width.max(1) as f32,
        height: port.height.max(1) as f32,
        min_depth: 0.0,
        max_depth: 1.0,
    };
    let scissor = vk::Rect2D {
        offset: vk::Offset2D {
            x: part.x as i32,
            y: part.y as i32,
        },
        extent: vk::Extent2D {
            width: part.width,
            height: part.height,
        },
    };
    // SAFETY: this function's contract.
    unsafe {
        device.cmd_set_viewport(cmd, 0, &[viewport]);
        device.cmd_set_scissor(cmd, 0, &[scissor]);
    }
}

impl Staged {
    /// Brings the places of control vertices where they are shown.
    fn place(&mut self, part: &Part) -> Result<()> {
        if self.moves == part.moves() || part.points().len() != self.model.mesh().vertex_count() {
            return Ok(());
        }
        let placement = self.model.placement();
        let local = |&point: &DVec3| placement.local(point).as_vec3();
        let placed: Vec<Vec3> = part.points().iter().map(local).collect();
        let positions: Vec<[f32; 3]> = placed.iter().map(|place| place.to_array()).collect();
        for drawn in &mut self.sides {
            drawn.surface.write_positions(&positions)?;
            self.amends.add_moves(drawn, [&self.placed, &placed]);
        }
        self.placed = placed;
        self.moves = part.moves();
        Ok(())
    }

    /// Decides levels anew, where what they depend on has changed.
    fn decide(&mut self, viewer: &Viewer, cut: Cut, part: &Part, context: &Context) -> Result<()> {
        let size = [viewer.area.width, viewer.area.height];
        let tags = |by| (viewer.cutting_orbit(), by, part.moves(), size);
        let decision = Decision {
            cut,
            tags: viewer.cutting.adaptive.map(tags),
        };
        let decided = self.decided.as_ref() == Some(&decision);
        if decided && self.sides.iter().all(|drawn| drawn.list.is_some()) {
            return Ok(());
        }
        let tags = self.tags(viewer, cut.level, part)?;
        let device = context.device();
        for drawn in &mut self.sides {
            drawn.finish(context);
            let tags = tags.as_ref().filter(|_| !drawn.is_decided_there());
            let list = drawn.surface.draw_list(cut, tags)?;
            let memory = &mut device.memory();
            // SAFETY: nothing is drawn at this time; device and memory made the surface.
            unsafe { drawn.surface.write_draws(device.raw(), memory, &list) }?;
            drawn.vertices = vertices(drawn.surface.prepared(), &list);
            (drawn.list, drawn.few) = (Some(list), None);
        }
        self.decided = Some(decision);
        Ok(())
    }
}

/// The vertices that are evaluated of all patches.
fn vertices(prepared: &Prepared, list: &DrawList) -> u64 {
    let passes = prepared.passes.iter().enumerate();
    let patches = passes
        .flat_map(|(pass, all)| (0..all.patches.len() as u32).map(move |patch| (pass, patch)));
    let counts = patches.map(|(pass, patch)| list.vertices(prepared, pass, patch));
    counts.map(u64::from).sum()
}

/// The background, as `render` has it: two triangles behind everything.
pub fn background() -> ([ColouredVertex; 4], [[u32; 3]; 2]) {
    let corner = |x: f32, y: f32, [r, g, b]: [f32; 3]| ColouredVertex {
        clip: [x, y, 1.0, 1.0],
        colour: [r, g, b, 1.0],
    };
    let [top, bottom] = crate::output::picture::BACKGROUND;
    let vertices = [
        corner(-1.0, -1.0, top),
        corner(1.0, -1.0, top),
        corner(1.0, 1.0, bottom),
        corner(-1.0, 1.0, bottom),
    ];
    (vertices, [[0, 1, 2], [0, 2, 3]])
}
