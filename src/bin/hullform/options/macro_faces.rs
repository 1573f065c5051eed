//! Several faces a patch: options of whatever prepares a model with plans.

use clap::{Args, ValueEnum};
use hullform::method::MacroFaces;

/// Several faces a patch.
#[derive(Args)]
pub struct Macro {
    /// Draw several faces as one patch, by methods with plans and at whole levels: `none`, `rectangles` between lines from extraordinary vertices, or `quartets` of
    /// regular faces
    #[arg(
        long = "macro",
        value_name = "KIND",
        default_value = "none",
        hide_possible_values = true
    )]
    kind: Kind,
    /// The most faces along a side of a rectangle, 2 to 32; they can be cut into 64 / N segments each [default: what the level allows, 16 at most]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=32))]
    macro_span: Option<u32>,
}

/// Which faces are drawn together.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    None,
    Rectangles,
    Quartets,
}

/// What the paper limits rectangles to (Brainerd et al. 2016, figure 8).
const USUAL_SPAN: u32 = 16;

impl Macro {
    /// Whether any are.
    pub fn is_asked(&self) -> bool {
        self.kind != Kind::None
    }

    /// What is to be drawn together at tess levels up to `level`.
    pub fn faces(&self, level: f32) -> MacroFaces {
        let allowed = (64.0 / level.ceil()) as u32;
        match self.kind {
            Kind::None => MacroFaces::None,
            Kind::Rectangles => MacroFaces::Rectangles {
                span: self.macro_span.unwrap_or(allowed.clamp(2, USUAL_SPAN)),
            },
            Kind::Quartets => MacroFaces::Quartets,
        }
    }
}
