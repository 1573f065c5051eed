//! How a surface uses the device.

use crate::gpu::backend::Backend;
use crate::gpu::batches::Bounds;

/// Who gives patches their slots in the scratch ring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Slots {
    /// The control shaders, from a counter a batch.
    #[default]
    Counter,
    /// The host, by summing up beforehand. The same slots whatever runs when or how often.
    Host,
}

/// How a surface uses the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Who cuts patches into triangles.
    pub backend: Backend,
    /// Bytes of the scratch ring.
    pub ring_bytes: u64,
    /// Who gives slots.
    pub slots: Slots,
    /// Vertices that can be captured at once; 0 for none.
    pub capture_vertices: u32,
    /// Counts the vertices of each patch as they are evaluated, so that [`arrival`](super::TessellatedSurface::arrival) tells whether the device
    /// lost any. Costs an atomic operation a vertex. Not together with a capture, which tells as much.
    pub count_vertices: bool,
    /// The greatest level that will be drawn, 1..=64; for [`Backend::Geometry`] at most 32.
    pub greatest_level: f32,
    /// How many times the batches are drawn after one [`cmd_prepare`](super::TessellatedSurface::cmd_prepare); see
    /// [`again`](super::TessellatedSurface::again).
    pub rounds: u32,
    /// Whether [`cmd_draw`](super::TessellatedSurface::cmd_draw) records the barriers that batches need. Switch it off for dynamic rendering, which
    /// allows no such barrier: before each batch that [waits](super::Batch::waits) the engine then ends rendering, records
    /// [`cmd_ring_barrier`](super::ring::cmd_ring_barrier) with whatever its attachments need, and begins again with `LOAD`.
    pub barriers: bool,
    /// For tests: draws each vertex whose position has an odd number of bits a fiftieth of the picture away. Where faces differ on an edge by a
    /// single bit, a hole opens that one can see. What is captured stays as it is.
    pub amplify_cracks: bool,
}

impl Default for SurfaceOptions {
    /// The tessellator, a ring of 1 MiB with counters, no capture, no counts, every level, barriers by `cmd_draw`.
    fn default() -> SurfaceOptions {
        SurfaceOptions {
            backend: Backend::Tessellator,
            ring_bytes: 1 << 20,
            slots: Slots::Counter,
            capture_vertices: 0,
            count_vertices: false,
            rounds: 1,
            greatest_level: 64.0,
            barriers: true,
            amplify_cracks: false,
        }
    }
}

impl SurfaceOptions {
    /// What bounds a batch.
    pub(super) fn bounds(self) -> Bounds {
        let points = self.ring_bytes / 16;
        let vertices = if self.capture_vertices == 0 {
            u32::MAX / 2
        } else {
            self.capture_vertices
        };
        Bounds {
            points: points.min(u64::from(u32::MAX / 2)) as u32,
            vertices,
            backend: self.backend,
        }
    }
}
