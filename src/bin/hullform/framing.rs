//! What a camera has to frame: the surface as the device will draw it, wherever its patches bend and bumps lead it.

use glam::Vec3;
use hullform::gpu::{Cut, Fill, Pipelines, Slots, SurfaceOptions, View};
use hullform::host::{Area, Bench, Shot, Style};
use hullform::mesh::Model;
use hullform::method::{DepthTags, Displacement, Prepared};
use hullform::{Result, abi};

use crate::camera::{self, Camera};
use crate::drawing::{self, Drawing};
use crate::gpu::Gpu;
use crate::options::{Cutting, Points};

/// Vertices that are recorded at once: as many as 16 MiB hold.
const RECORDED: u32 = (16 << 20) / size_of::<abi::Captured>() as u32;

/// Above this many vertices a surface is framed at half its level, and so on.
const MANY: u64 = 1 << 17;

/// The same for a displaced one, whose bumps hide between vertices.
const MANY_DISPLACED: u64 = 1 << 21;

/// The level down to which that may go. Between points an n-th of a patch apart the surface goes beyond them by at most 1 / 8n^2 of its second
/// derivative, which is of the order of the patch: with 4 segments less than a fiftieth of it, where the frame leaves a twentieth of the
/// picture free.
const ENOUGH: f32 = 4.0;

/// What is framed.
pub struct Subject<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Where it will be drawn.
    pub bench: &'a Bench,
    /// As what: framing it builds no pipelines of its own then.
    pub fill: Fill,
    /// The model.
    pub model: &'a Model,
    /// What a method made of it.
    pub prepared: &'a Prepared,
    /// How it will be cut up.
    pub cutting: Cutting,
    /// How it will be displaced.
    pub displacement: Displacement,
    /// Bytes of the scratch ring.
    pub ring_bytes: u64,
    /// Who computes points.
    pub points: Points,
}

/// What is seen of it.
pub struct Framed {
    /// From where.
    pub view: camera::View,
    /// The depth tags that the cutting asks for there.
    pub tags: Option<DepthTags>,
    /// The part of the picture in which it is; the rest is empty.
    pub area: Area,
}

impl Subject<'_> {
    /// What `camera` sees in a picture of `size` pixels.
    ///
    /// The vertices come from the device, undrawn, by the very shaders that will draw them: so displacement, spacing and back-end are what
    /// they will be.
    pub fn framed(&self, camera: Camera, size: [u32; 2]) -> Result<Framed> {
        let Cutting {
            cut,
            backend,
            residence,
            ..
        } = self.cutting;
        let options = SurfaceOptions {
            backend,
            residence,
            ring_bytes: self.ring_bytes,
            // These hold whatever runs how often.
            slots: Slots::Host,
            capture_vertices: RECORDED,
            greatest_level: cut.level,
            ..Default::default()
        };
        let prepared = self.prepared.clone();
        let (gpu, bench) = (self.gpu, self.bench);
        let mut drawing = Drawing::new(gpu, bench, self.model, prepared, options, self.points)?;
        let style = Style::new(options, cut.spacing, self.fill);
        let pipelines = bench.pipelines(self.prepared, style)?;
        self.look(&mut drawing, &pipelines, camera, size)
    }

    fn look(
        &self,
        drawing: &mut Drawing<'_>,
        pipelines: &Pipelines,
        camera: Camera,
        [width, height]: [u32; 2],
    ) -> Result<Framed> {
        let size = [width, height].map(|side| side as f32);
        let mut frame = |cut: Cut, tags: Option<&DepthTags>| {
            let mut positions = Vec::new();
            drawing.tags = tags.cloned();
            for batch in drawing.draw_list(cut)?.batches() {
                drawing.draw(&[Shot {
                    pipelines,
                    view: self.view(),
                    instances: 1,
                    batches: vec![batch],
                }])?;
                drawing.check([batch])?;
                let captured = drawing.surface().captured()?.iter();
                positions.extend(captured.map(|vertex| Vec3::from(vertex.position)));
            }
            let view = camera.frame(&positions, size[0] / size[1]);
            let tags = drawing.tags_for(self.model, self.cutting, &view, size)?;
            let area = view.area(&positions, [width, height]);
            Ok(Framed { view, tags, area })
        };
        let mut framed = frame(self.coarse(), None)?;
        if self.displacement.height != 0.0 {
            if framed.tags.is_some() {
                // With fewer vertices fewer bumps are met.
                framed.view = frame(self.cutting.cut, framed.tags.as_ref())?.view;
            }
            // A bump that was not met may be anywhere.
            framed.area = Area {
                x: 0,
                y: 0,
                width,
                height,
            };
        }
        Ok(framed)
    }

    fn view(&self) -> View {
        View {
            displacement: self.displacement,
            ..drawing::nowhere()
        }
    }

    /// The cut that is enough to know where the surface goes.
    fn coarse(&self) -> Cut {
        let many = if self.displacement.height == 0.0 {
            MANY
        } else {
            MANY_DISPLACED
        };
        let mut cut = self.cutting.cut;
        while cut.level > ENOUGH && self.vertices(cut) > many {
            cut.level = (0.5 * cut.level).max(ENOUGH);
        }
        cut
    }

    fn vertices(&self, cut: Cut) -> u64 {
        let cut = self.cutting.backend.cut(cut);
        let passes = self.prepared.passes.iter();
        passes
            .flat_map(|pass| {
                (0..pass.patches.len()).map(move |patch| u64::from(cut.vertices(pass, patch)))
            })
            .sum()
    }
}
