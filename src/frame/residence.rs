//! Where control points live.

/// Where the control points live of patches that are evaluated by stencils.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Residence {
    /// In the scratch ring: the control shaders compute them as they go (Brainerd et al. 2016, section 5). Memory is bounded, and every draw
    /// computes them again. Best for a single pass over what moves.
    #[default]
    Ring,
    /// In a cache of the pose: a compute pass computes each once (section 8.2), for any number of passes, views, frames and back-ends. No draw
    /// waits for another.
    Cache,
}

impl Residence {
    /// All.
    pub const ALL: [Residence; 2] = [Residence::Ring, Residence::Cache];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Residence::Ring => "ring",
            Residence::Cache => "cache",
        }
    }
}
