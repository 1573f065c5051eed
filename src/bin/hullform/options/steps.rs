//! How finely surfaces are cut, by whom, and where their control points live.

use std::ffi::OsStr;

use clap::builder::{EnumValueParser, PossibleValue, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, Args, Command, ValueEnum};

use super::{Cutting, Spacing, level};

/// How finely: options of whatever tessellates.
#[derive(Args)]
pub struct Steps {
    /// Tessellation level, 1 to 64; up to 1024 with the tessellator, equal spacing and methods of quads: patches are cut into pieces first
    #[arg(long, default_value = "8", value_parser = level)]
    pub level: f32,
    /// Spacing of the vertices along an edge
    #[arg(long, default_value = "equal", value_parser = SpacingParser)]
    pub spacing: Spacing,
    /// Who cuts patches into triangles; all but the tessellator raise levels to powers of two
    #[arg(long, value_name = "WHO", default_value = "tessellator")]
    pub backend: Backend,
    /// Where control points live of patches that need more than their vertices
    #[arg(long, value_name = "WHERE", default_value = "ring")]
    pub residence: Residence,
}

/// Reads a spacing; tells why there is no fractional-odd, see the manual, *Tess levels*.
#[derive(Clone)]
pub struct SpacingParser;

/// Vulkan's spacing that is refused.
const FRACTIONAL_ODD: &str = "fractional-odd";

impl TypedValueParser for SpacingParser {
    type Value = Spacing;

    fn parse_ref(
        &self,
        cmd: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> Result<Spacing, clap::Error> {
        if value == FRACTIONAL_ODD {
            let words = "--spacing fractional-odd: its short segments may begin at a corner, nearer than any plan goes, and beside n-gons no odd number is twice another; choose fractional-even\n";
            return Err(clap::Error::raw(ErrorKind::ValueValidation, words).with_cmd(cmd));
        }
        EnumValueParser::<Spacing>::new().parse_ref(cmd, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let values = Spacing::value_variants().iter();
        Some(Box::new(values.filter_map(Spacing::to_possible_value)))
    }
}

/// Where control points live.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Residence {
    /// In the scratch ring: control shaders compute them as they go
    Ring,
    /// In a cache: a compute pass computes each once
    Cache,
}

impl From<Residence> for hullform::gpu::Residence {
    fn from(residence: Residence) -> Self {
        match residence {
            Residence::Ring => hullform::gpu::Residence::Ring,
            Residence::Cache => hullform::gpu::Residence::Cache,
        }
    }
}

/// Who cuts patches into triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// The tessellator, between control and evaluation shaders
    Tessellator,
    /// Refinement patterns in instances, evaluated in the vertex shader
    Pattern,
    /// The geometry shader, up to level 32
    Geometry,
}

impl From<Backend> for hullform::gpu::Backend {
    fn from(backend: Backend) -> Self {
        hullform::gpu::Backend::ALL[backend as usize]
    }
}

impl Steps {
    /// As the library takes it.
    pub fn cutting(&self) -> Cutting {
        Cutting {
            cut: hullform::gpu::Cut {
                level: self.level,
                spacing: self.spacing.into(),
            },
            backend: self.backend.into(),
            residence: self.residence.into(),
            adaptive: None,
        }
    }
}
