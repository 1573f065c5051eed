//! How a surface uses the device.

#[cfg(feature = "vulkan")]
use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::batches::Bounds;
use crate::frame::sub_patches::has_sub_patches;
#[cfg(feature = "vulkan")]
use crate::frame::sub_patches::most_sub_patches;
use crate::frame::{Backend, Cut, Residence};
#[cfg(feature = "vulkan")]
use crate::method::Pass;
use crate::method::{MacroFaces, Prepared};
use crate::tessellation::{Domain, Spacing};

/// Who gives patches their slots in the scratch ring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Slots {
    /// The control shaders, from a counter a batch.
    #[default]
    Counter,
    /// The host, by summing up beforehand. The same slots whatever runs when or how often.
    Host,
}

/// Who decides about the levels of patches, and whether they are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decides {
    /// The host, with its draw list: the cut, or depth tags.
    #[default]
    Host,
    /// A compute pass in each frame and for each view, by a [`Decision`](super::Decision), with `gpu::FrameSlot::cmd_decide`. For the tessellator, with slots by
    /// counters, and without depth tags or counted vertices.
    Device,
}

/// How a surface uses the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Who cuts patches into triangles.
    pub backend: Backend,
    /// Where control points live.
    pub residence: Residence,
    /// Bytes of the scratch ring; there is none where control points are cached.
    pub ring_bytes: u64,
    /// Who gives slots.
    pub slots: Slots,
    /// Who decides about patches. The device takes some 30 bytes a patch and view, and 24 a control vertex and pose.
    pub decides: Decides,
    /// Vertices that can be captured at once; 0 for none.
    pub capture_vertices: u32,
    /// Vertices that a batch has at most, unless a single patch has more: for frames that are drawn in slices, batch by batch. `u32::MAX` where that does not
    /// matter.
    pub batch_vertices: u32,
    /// Counts the vertices of each patch as they are evaluated, so that `gpu::TessellatedSurface::arrival` tells whether the device lost any.
    /// Costs an atomic operation a vertex. Not together with a capture, which tells as much.
    pub count_vertices: bool,
    /// The greatest level that will be drawn, 1..=64; for [`Backend::Geometry`] at most 32. Up to 1024 for [`Backend::Tessellator`] where the host decides and
    /// patches are quads: those with more than 64 segments are cut into pieces before they are drawn, at equal spacing. What is drawn then takes 32 bytes a
    /// piece; pipelines are made for it, `gpu::PipelineOptions::sub_patches`.
    pub greatest_level: f32,
    /// How many times the batches are drawn after one `cmd_prepare`, 1 at least; see
    /// [`DrawList::round`](super::DrawList::round).
    pub rounds: u32,
    /// How many views a frame may have; 84 bytes each.
    pub views: u32,
    /// Whether `cmd_draw` records the barriers that batches need. Switch it off for dynamic rendering, which
    /// allows no such barrier: before each batch that [waits](super::Batch::waits) the engine then ends rendering, records
    /// `gpu::ring::cmd_ring_barrier` with whatever its attachments need, and begins again with `LOAD`.
    pub barriers: bool,
    /// For tests: draws each vertex whose position has an odd number of bits a fiftieth of the picture away. Where faces differ on an edge by a
    /// single bit, a hole opens that one can see. What is captured stays as it is.
    pub amplify_cracks: bool,
}

impl Default for SurfaceOptions {
    /// The tessellator, control points in a ring of 1 MiB with counters, decided by the host, no capture, batches of any size, no counts, every level, one round, 64 views,
    /// barriers by `cmd_draw`.
    fn default() -> SurfaceOptions {
        SurfaceOptions {
            backend: Backend::Tessellator,
            residence: Residence::Ring,
            ring_bytes: 1 << 20,
            slots: Slots::Counter,
            decides: Decides::Host,
            capture_vertices: 0,
            batch_vertices: u32::MAX,
            count_vertices: false,
            rounds: 1,
            views: 64,
            greatest_level: 64.0,
            barriers: true,
            amplify_cracks: false,
        }
    }
}

impl SurfaceOptions {
    /// Whether what was prepared can be drawn so, whatever the cut.
    ///
    /// # Errors
    /// [`Misuse`], see there: no round, a greatest level that is none, a backend that cannot.
    pub fn check(&self, prepared: &Prepared) -> Result<()> {
        if self.rounds == 0 {
            return Err(Error::Misuse(Misuse::NoRounds));
        }
        if self.count_vertices && self.capture_vertices > 0 {
            return Err(Error::Misuse(Misuse::CountedAndCaptured));
        }
        self.check_decides()?;
        check_level(self.greatest_level, Spacing::Equal.greatest())?;
        self.check_sub_patches(prepared)?;
        self.check_macro_faces(prepared)?;
        self.backend
            .check(prepared, self.residence, self.greatest_level)
    }

    /// Sides of macro faces are of several edges, which tessellators make at once, and as many as they can.
    ///
    /// # Errors
    /// [`Misuse::MacroFaces`] and [`Misuse::MacroLevel`] for what does not go with macro faces.
    fn check_macro_faces(&self, prepared: &Prepared) -> Result<()> {
        let faces = prepared.macro_faces;
        let what = match () {
            () if faces == MacroFaces::None => return Ok(()),
            () if self.backend != Backend::Tessellator => "another backend than the tessellator",
            () if self.greatest_level > faces.greatest_level() as f32 => {
                return Err(Error::Misuse(Misuse::MacroLevel {
                    span: faces.span(),
                    greatest: faces.greatest_level(),
                }));
            }
            () => return Ok(()),
        };
        Err(Error::Misuse(Misuse::MacroFaces { what }))
    }

    /// # Errors
    /// [`Misuse::SubPatchesOfTriangles`] and [`Misuse::DecidedByDevice`].
    fn check_sub_patches(&self, prepared: &Prepared) -> Result<()> {
        let mut passes = prepared.passes.iter();
        match () {
            () if !self.has_sub_patches() => Ok(()),
            () if self.decides == Decides::Device => {
                let what = "levels above 64";
                Err(Error::Misuse(Misuse::DecidedByDevice { what }))
            }
            () if passes.any(|pass| pass.domain == Domain::Triangles) => {
                Err(Error::Misuse(Misuse::SubPatchesOfTriangles))
            }
            () => Ok(()),
        }
    }

    /// # Errors
    /// [`Misuse::DecidedByDevice`] for what only goes with decisions of the host.
    fn check_decides(&self) -> Result<()> {
        let host_slots = self.slots == Slots::Host && self.residence == Residence::Ring;
        let what = match () {
            () if self.decides == Decides::Host => return Ok(()),
            () if !self.backend.is_decided() => "another backend than the tessellator",
            () if host_slots => "slots by the host",
            () if self.count_vertices => "counted vertices",
            () => return Ok(()),
        };
        Err(Error::Misuse(Misuse::DecidedByDevice { what }))
    }

    /// Whether patches may have more segments than a tessellator makes, so that pipelines have to know of pieces.
    pub fn has_sub_patches(&self) -> bool {
        has_sub_patches(self.greatest_level)
    }

    /// The bytes of all sub-patches that a pass may have.
    #[cfg(feature = "vulkan")]
    pub(crate) fn sub_patch_bytes(&self, pass: &Pass) -> u64 {
        match self.has_sub_patches() {
            true => size_of::<abi::SubPatch>() as u64 * most_sub_patches(pass, self.greatest_level),
            false => 0,
        }
    }

    /// A cut as the backend makes it.
    ///
    /// # Errors
    /// [`Misuse::Level`] for a level that is none, or above the greatest; [`Misuse::SubPatchSpacing`].
    pub(super) fn cut(&self, cut: Cut) -> Result<Cut> {
        check_level(cut.level, self.greatest_level)?;
        if cut.level > cut.spacing.greatest() {
            return Err(Error::Misuse(Misuse::SubPatchSpacing));
        }
        // Where vertices are counted levels are whole.
        let level = match has_sub_patches(cut.level) {
            true => cut.level.ceil(),
            false => cut.level,
        };
        Ok(self.backend.cut(Cut { level, ..cut }))
    }

    /// What bounds a batch, with an instance's vertices where the driver bounds those.
    pub(crate) fn bounds(&self, instance_vertices: Option<u32>) -> Bounds {
        let vertices = match self.capture_vertices {
            0 => u32::MAX / 2,
            captured => captured,
        };
        let vertices = vertices.min(self.batch_vertices);
        Bounds {
            ring: (self.residence == Residence::Ring).then(|| self.ring_points()),
            vertices,
            backend: self.backend,
            instance_vertices: instance_vertices.filter(|_| self.backend.is_bounded()),
        }
    }

    /// Whether the host gives slots in the ring.
    pub(super) fn has_host_slots(&self) -> bool {
        self.slots == Slots::Host && self.residence == Residence::Ring
    }

    /// Points that the ring holds.
    pub fn ring_points(&self) -> u32 {
        (self.ring_bytes / 16).min(u64::from(u32::MAX / 2)) as u32
    }

    /// The cuts that need the most batches.
    pub(crate) fn greatest_cuts(&self) -> [Cut; 2] {
        [Spacing::Equal, Spacing::FractionalEven].map(|spacing| Cut {
            level: self.greatest_level.min(spacing.greatest()),
            spacing,
        })
    }
}

fn check_level(level: f32, greatest: f32) -> Result<()> {
    // What is no number is not contained either.
    if (1.0..=greatest).contains(&level) {
        return Ok(());
    }
    Err(Error::Misuse(Misuse::Level { level, greatest }))
}
