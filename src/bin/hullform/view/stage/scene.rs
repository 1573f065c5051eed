//! A scene as it is drawn: in one frame, or in slices over several, so that what takes long leaves the window time in between. What it shows was decided when it began.

use std::ops::Range;
use std::sync::Arc;

use hullform::Result;
use hullform::ash::vk;
use hullform::gpu::{self, Batch, Decision, Pipelines, View, ring};
use hullform::host::{OffscreenTarget, Owned, Slice};

use super::{Cost, Side, Stage, Staged, cmd_look, style, view};
use crate::eye::Sphere;
use crate::render;
use crate::view::context::{Context, Drawn};
use crate::view::viewer::Viewer;
use crate::view::viewport::Area;

/// A point of the ring takes as long as so many vertices.
const POINT: f64 = 0.5;
/// A vertex whose place the host has told takes as long as so many that are evaluated.
const FLAT: f64 = 0.1;

/// A scene that is being drawn.
pub struct Scene {
    /// The level at which surfaces are cut.
    pub level: f32,
    /// Where it is in the window.
    pub area: Area,
    /// What it has taken so far.
    pub cost: Cost,
    /// The part that is drawn, where the rest of the picture stays.
    pub part: Option<Area>,
    all: Sphere,
    sides: Vec<Side>,
    views: Vec<Seen>,
    steps: Vec<Step>,
    at: Cursor,
    end: Cursor,
    /// Before anything is drawn, the points of caches that the next slice computes, where these are too many for one.
    filling: Option<u32>,
}

/// With what views a surface is prepared.
struct Seen {
    part: usize,
    recipe: usize,
    /// What is seen, and where another camera decides what that sees.
    views: Vec<View>,
    /// What the device decides, where it does.
    decision: Option<Decision>,
}

/// Something that is drawn in a side.
struct Step {
    side: usize,
    what: What,
}

enum What {
    /// A map of errors.
    Map,
    /// Lines over the surfaces.
    Overlay,
    /// The batches of a surface.
    Surface {
        part: usize,
        round: u32,
        pipelines: Arc<Owned<Pipelines>>,
        /// The work that each of them is; none where nothing of it is drawn.
        works: Arc<[f64]>,
    },
}

/// Some of the batches of a surface.
pub(super) struct Batches<'a> {
    /// From which to which.
    pub range: Range<usize>,
    /// The work that each of all is.
    pub works: &'a [f64],
    /// Whether they are those of a part of the picture.
    pub is_part: bool,
}

/// How far it is drawn: a step, and a batch of that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Cursor {
    step: usize,
    batch: usize,
}

/// What a frame draws of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliced {
    /// In units of a vertex.
    pub work: f64,
    /// Whether it is whole afterwards.
    pub is_last: bool,
}

impl Stage {
    /// Begins a scene of what was decided, in the place of one that is not whole. What has no pipelines yet is not drawn.
    pub fn begin(&mut self, viewer: &Viewer, level: f32, context: &Context) -> Result<()> {
        self.begin_of(viewer, level, None, context)
    }

    /// The same, of a part of the picture or all of it.
    pub(super) fn begin_of(
        &mut self,
        viewer: &Viewer,
        level: f32,
        part: Option<Area>,
        context: &Context,
    ) -> Result<()> {
        let mut sides = Stage::sides(viewer);
        for side in &mut sides {
            side.scissor = part.map_or(side.scissor, |part| side.scissor.and(part));
        }
        let mut scene = Scene {
            level,
            area: viewer.area,
            part,
            all: viewer.sphere(),
            cost: Cost::default(),
            views: Vec::new(),
            steps: Vec::new(),
            at: Cursor::default(),
            end: Cursor::default(),
            filling: None,
            sides,
        };
        for (number, side) in scene.sides.iter().enumerate() {
            let step = |what| Step { side: number, what };
            for (part, staged) in self.parts.iter().enumerate() {
                let Some(drawn) = staged.sides.get(side.recipe) else {
                    continue;
                };
                scene.views.push(Seen {
                    part,
                    recipe: side.recipe,
                    ..staged.seen(viewer, drawn, side.viewport, context)?
                });
                // What is not measured yet is seen as it is.
                if self.mapped.contains(&(side.recipe, staged.number)) {
                    continue;
                }
                let Some(works) = drawn.works(scene.part.is_some()) else {
                    continue;
                };
                let few = drawn.few.as_ref().filter(|_| scene.part.is_some());
                scene.cost.vertices += few.map_or(drawn.vertices, |few| few.vertices);
                for (round, fill) in (0..).zip(Stage::fills(viewer)) {
                    let key = drawn.key(style(drawn, viewer, fill));
                    if let Some(pipelines) = context.ready_or_like(&key) {
                        scene.steps.push(step(What::Surface {
                            part,
                            round,
                            pipelines,
                            works: works.clone(),
                        }));
                    }
                }
            }
            if self.mapped.iter().any(|(recipe, _)| *recipe == side.recipe) {
                scene.steps.push(step(What::Map));
            }
            scene.steps.push(step(What::Overlay));
        }
        self.scene = Some(scene);
        // Until it is whole there is none.
        self.shown = None;
        self.parts
            .iter_mut()
            .for_each(|staged| staged.amends.clear());
        Ok(())
    }

    /// Whether a scene is begun and not whole.
    pub fn is_drawing(&self) -> bool {
        self.scene.is_some()
    }

    /// The scene that is not whole.
    pub fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    /// Leaves a scene that is not whole, and whatever the picture shows.
    pub fn abandon(&mut self) {
        (self.scene, self.shown) = (None, None);
    }

    /// What the next frame draws of the scene: something, and no more than so much work if that can be helped.
    pub fn slice(&mut self, most: f64) -> Option<Sliced> {
        let mut scene = self.scene.take()?;
        let sliced = scene.plan(self, most);
        self.scene = Some(scene);
        Some(sliced)
    }

    /// Records what was asked for last; the scene as it was, where it is whole now.
    ///
    /// # Safety
    /// `cmd` is recording on the device of the context, outside of a render pass; what was recorded of the scene before was executed.
    pub unsafe fn record(
        &mut self,
        cmd: vk::CommandBuffer,
        target: &OffscreenTarget,
        context: &Context,
    ) -> Result<Option<Cost>> {
        let Some(mut scene) = self.scene.take() else {
            return Ok(None);
        };
        let started = std::time::Instant::now();
        let _span = tracing::debug_span!("record").entered();
        // SAFETY: this function's contract, here and below.
        unsafe {
            if let Some(timer) = &self.timer {
                timer.cmd_begin(cmd);
            }
            self.cmd_slice(cmd, target, context, &mut scene)?;
            if let Some(timer) = &self.timer {
                timer.cmd_end(cmd);
                self.timed = true;
            }
        }
        scene.at = scene.end;
        scene.cost.host += started.elapsed().as_secs_f64();
        if scene.at.step == scene.steps.len() {
            self.shown = Some((scene.level, scene.all));
            return Ok(Some(scene.cost));
        }
        self.scene = Some(scene);
        Ok(None)
    }

    /// # Safety
    /// As [`record`](Self::record).
    unsafe fn cmd_slice(
        &mut self,
        cmd: vk::CommandBuffer,
        target: &OffscreenTarget,
        context: &Context,
        scene: &mut Scene,
    ) -> Result<()> {
        if let Some(points) = scene.filling {
            // SAFETY: this function's contract.
            return unsafe { self.cmd_fill(cmd, context, scene, points) };
        }
        let device = context.device().raw();
        let (slice, is_part) = (scene.kind(), scene.part.is_some());
        // SAFETY: this function's contract; slices come in their order.
        unsafe {
            if slice.begins() {
                for seen in &scene.views {
                    let drawn = &mut self.parts[seen.part].sides[seen.recipe];
                    scene.cost.points +=
                        drawn.cmd_prepare(cmd, context, &seen.views, seen.decision.as_ref())?;
                }
            } else {
                ring::cmd_ring_barrier(device, cmd);
            }
            target.begin_slice(cmd, render::CLEAR, slice);
            let mut side = None;
            for number in scene.at.step..scene.steps.len() {
                let batches = scene.batches_of(number);
                if batches.is_empty() {
                    break;
                }
                let step = &scene.steps[number];
                if side.replace(step.side) != Some(step.side) {
                    cmd_look(device, cmd, &scene.sides[step.side]);
                }
                let recipe = scene.sides[step.side].recipe;
                match &step.what {
                    What::Map => self.maps[recipe].cmd_draw(cmd),
                    What::Overlay => self.overlay.cmd_draw(cmd),
                    What::Surface {
                        part,
                        round,
                        pipelines,
                        works,
                    } => {
                        let batches = Batches {
                            range: batches,
                            works,
                            is_part,
                        };
                        let drawn = &self.parts[*part].sides[recipe];
                        let cost = &mut scene.cost;
                        drawn.cmd_batches(cmd, context, *round, batches, pipelines, cost)?;
                    }
                }
            }
            target.end(cmd);
            if slice.ends() {
                for seen in &scene.views {
                    let drawn = &self.parts[seen.part].sides[seen.recipe];
                    if seen.decision.is_some() {
                        drawn.surface.cmd_read_back(device, cmd);
                    }
                }
            }
        }
        Ok(())
    }
}

impl Stage {
    /// Computes so many points of caches.
    ///
    /// # Safety
    /// As [`record`](Self::record).
    unsafe fn cmd_fill(
        &mut self,
        cmd: vk::CommandBuffer,
        context: &Context,
        scene: &mut Scene,
        mut points: u32,
    ) -> Result<()> {
        for seen in &scene.views {
            let drawn = &mut self.parts[seen.part].sides[seen.recipe];
            // SAFETY: this function's contract.
            let filled = unsafe { drawn.cmd_fill(cmd, context, points) }?;
            scene.cost.points += u64::from(filled);
            points -= filled.min(points);
        }
        Ok(())
    }
}

impl Staged {
    /// With what views a surface of it is prepared for an area of the window, and what is decided there.
    fn seen(&self, viewer: &Viewer, drawn: &Drawn, area: Area, context: &Context) -> Result<Seen> {
        let eyes = std::iter::once(viewer.orbit).chain(viewer.frozen);
        let views = eyes.map(|orbit| view(viewer, orbit.eye(), &self.model, area));
        let part = viewer
            .parts
            .iter()
            .find(|part| part.number() == self.number);
        let decided = part.filter(|_| drawn.is_decided_there());
        let samples = context.mould().samples().as_raw();
        let limits = context.device().limits();
        let has_standard_samples = limits.standard_sample_locations != 0;
        let decision = decided.map(|part| self.decision(viewer, part, drawn, (area, samples)));
        Ok(Seen {
            part: 0,
            recipe: 0,
            views: views.collect(),
            decision: decision.transpose()?.map(|decision| {
                // What is shown may be older than what is wanted, and have its cracks amplified: then no patch may be left out.
                let whole = drawn.surface.options().amplify_cracks;
                gpu::Decision {
                    frustum: decision.frustum && !whole,
                    back: decision.back && !whole,
                    // Whoever has samples in places of its own shows what is between the usual ones.
                    small: decision.small.filter(|_| has_standard_samples && !whole),
                    ..decision
                }
            }),
        })
    }
}

/// What a batch takes, in vertices.
pub(super) fn work_of(batch: Batch<'_>) -> f64 {
    work(batch.vertices(), batch.points())
}

/// What so many vertices and points take.
pub(super) fn work(vertices: u32, points: u32) -> f64 {
    f64::from(vertices) + POINT * f64::from(points)
}

impl Scene {
    /// Decides what the next frame draws.
    fn plan(&mut self, stage: &Stage, most: f64) -> Sliced {
        let mut end = self.at;
        let mut work = match self.at == Cursor::default() {
            true => POINT * self.uncached(stage),
            false => 0.0,
        };
        self.filling = (work > most).then_some((most / POINT) as u32);
        if self.filling.is_some() {
            (self.end, work) = (self.at, most);
            let is_last = false;
            return Sliced { work, is_last };
        }
        'steps: while let Some(step) = self.steps.get(end.step) {
            let recipe = self.sides[step.side].recipe;
            match &step.what {
                What::Surface { works, .. } => {
                    for own in works.iter().skip(end.batch) {
                        if work > 0.0 && work + own > most {
                            break 'steps;
                        }
                        work += own;
                        end.batch += 1;
                    }
                }
                What::Map => work += FLAT * stage.flat[recipe] as f64,
                What::Overlay => work += FLAT * stage.flat[2] as f64,
            }
            end = Cursor {
                step: end.step + 1,
                batch: 0,
            };
        }
        self.end = end;
        Sliced {
            work,
            is_last: end.step == self.steps.len(),
        }
    }

    /// The points of caches that are to be computed before anything is drawn.
    fn uncached(&self, stage: &Stage) -> f64 {
        let drawn = self
            .views
            .iter()
            .map(|seen| &stage.parts[seen.part].sides[seen.recipe]);
        drawn.map(|drawn| f64::from(drawn.uncached())).sum()
    }

    /// The work that all of it is.
    pub fn work(&self) -> f64 {
        let steps = self.steps.iter().filter_map(|step| match &step.what {
            What::Surface { works, .. } => Some(works.iter()),
            _ => None,
        });
        steps.flatten().sum()
    }

    /// Which slice of the picture comes next.
    fn kind(&self) -> Slice {
        let is_first = self.at == Cursor::default();
        let is_last = self.end.step == self.steps.len();
        match (is_first, is_last, self.part.is_some()) {
            (true, true, false) => Slice::Whole,
            (true, true, true) => Slice::Part,
            (true, false, _) => Slice::First,
            (false, false, _) => Slice::Between,
            (false, true, false) => Slice::Last,
            (false, true, true) => Slice::LastOfPart,
        }
    }

    /// Which batches of a step are drawn next; of what has none, the first stands for all.
    fn batches_of(&self, step: usize) -> Range<usize> {
        let first = if step == self.at.step {
            self.at.batch
        } else {
            0
        };
        match step.cmp(&self.end.step) {
            std::cmp::Ordering::Less => first..usize::MAX,
            std::cmp::Ordering::Equal => first..self.end.batch,
            std::cmp::Ordering::Greater => 0..0,
        }
    }
}
