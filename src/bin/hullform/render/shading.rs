//! What the colours of a picture mean.

use clap::ValueEnum;
use hullform::gpu;

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
