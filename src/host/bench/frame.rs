//! What a submission gave.

use crate::abi::Captured;
use crate::gpu::Counters;

/// What a submission, or one a pass, gave.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Captured vertices, a list a pass; each by patch, v and u, once.
    pub passes: Vec<Vec<Captured>>,
    /// What the control shaders counted.
    pub counters: Counters,
    /// Control shader patches, evaluation shader invocations, clipping primitives; where the device counts them.
    pub statistics: Option<[u64; 3]>,
    /// Vertices that came more than once, with different bits.
    pub differing: usize,
}

impl Frame {
    /// Everything that was captured, as words to compare.
    pub fn bits(&self) -> Vec<[u32; 9]> {
        self.passes.iter().flatten().map(vertex_bits).collect()
    }

    pub(super) fn add(&mut self, mut other: Frame, pass: usize) {
        self.passes[pass].append(&mut other.passes[0]);
        self.counters.overflows += other.counters.overflows;
        self.counters.points = self.counters.points.wrapping_add(other.counters.points);
        self.differing += other.differing;
        self.statistics = match (self.statistics, other.statistics) {
            (Some(a), Some(b)) => Some(std::array::from_fn(|i| a[i] + b[i])),
            (a, b) => a.or(b),
        };
    }
}

/// The order in which captured vertices are told: by patch, v and u.
pub fn vertex_key(vertex: &Captured) -> (u32, u32, u32) {
    let [u, v] = vertex.uv.map(f32::to_bits);
    (vertex.patch_number, v, u)
}

/// Everything about a vertex, for comparisons without tolerance.
pub fn vertex_bits(vertex: &Captured) -> [u32; 9] {
    bytemuck::cast(*vertex)
}
