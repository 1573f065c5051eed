//! Who cuts patches into triangles: the three implementations of section 3.2 of Boubekeur, Schlick 2007.

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Cut, Residence};
use crate::method::Prepared;
use crate::tessellation::{Levels, Spacing, lattice_rows, lattice_vertices};

/// Who cuts patches into triangles. All have them evaluated by the same functions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Backend {
    /// The tessellator, between control and evaluation shader: any level, either spacing, every method.
    #[default]
    Tessellator,
    /// The host. A refinement pattern for each combination of levels is kept as a list of indices, and drawn as an instance a patch; the vertex
    /// shader evaluates. Levels are powers of two, and at level 2^d a triangle is what d splits in four make of it. For patches that need no
    /// scratch ring, or whose control points are cached.
    Pattern,
    /// The geometry shader, a row of triangles an invocation. Levels are powers of two, 32 at most, since devices need not have more than 32
    /// invocations and 1024 components of output. For patches that need no scratch ring; needs the feature `geometryShader`.
    Geometry,
}

impl Backend {
    /// All.
    pub const ALL: [Backend; 3] = [Backend::Tessellator, Backend::Pattern, Backend::Geometry];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Backend::Tessellator => "tessellator",
            Backend::Pattern => "pattern",
            Backend::Geometry => "geometry",
        }
    }

    /// A cut as it will be: all but the tessellator raise levels to powers of two, and space evenly.
    pub fn cut(self, cut: Cut) -> Cut {
        match self {
            Backend::Tessellator => cut,
            Backend::Pattern | Backend::Geometry => Cut {
                level: (cut.level.clamp(1.0, 64.0).ceil() as u32).next_power_of_two() as f32,
                spacing: Spacing::Equal,
            },
        }
    }

    /// The level of a depth: whole depths have powers of two, to the last bit.
    pub(crate) fn level_of(self, depth: f32) -> f32 {
        let whole = depth.floor();
        let level = (1u32 << whole as u32) as f32;
        match self {
            Backend::Tessellator => level * (depth - whole).exp2(),
            Backend::Pattern | Backend::Geometry => (1u32 << depth.ceil() as u32) as f32,
        }
    }

    /// How many vertices the evaluating shader captures of a patch, each run of it counted.
    pub(crate) fn vertices(self, levels: &Levels, spacing: Spacing) -> u32 {
        match self {
            Backend::Tessellator => levels.vertices(spacing),
            Backend::Pattern => lattice_vertices(levels),
            Backend::Geometry => lattice_rows(levels),
        }
    }

    /// Whether it can draw what was prepared, at up to `level`.
    ///
    /// # Errors
    /// [`Misuse::BackendWithoutRing`] and [`Misuse::BackendLevel`] when it cannot.
    pub fn check(self, prepared: &Prepared, residence: Residence, level: f32) -> Result<()> {
        if self == Backend::Tessellator {
            return Ok(());
        }
        let mut passes = prepared.passes.iter();
        let ring = residence == Residence::Ring;
        if ring && passes.any(|pass| !pass.scratch_points.is_empty()) {
            return Err(Error::Misuse(Misuse::BackendWithoutRing {
                backend: self.name(),
            }));
        }
        let cut = Cut {
            level,
            spacing: Spacing::Equal,
        };
        let greatest = abi::GEOMETRY_ROWS as f32;
        if self == Backend::Geometry && self.cut(cut).level > greatest {
            return Err(Error::Misuse(Misuse::BackendLevel {
                backend: self.name(),
                greatest,
            }));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_raise_levels_to_powers_of_two() {
        for (level, raised) in [
            (1.0, 1.0),
            (2.5, 4.0),
            (8.0, 8.0),
            (33.0, 64.0),
            (64.0, 64.0),
        ] {
            let cut = Cut {
                level,
                spacing: Spacing::FractionalEven,
            };
            assert_eq!(
                Backend::Pattern.cut(cut),
                Cut {
                    level: raised,
                    spacing: Spacing::Equal
                }
            );
            assert_eq!(Backend::Tessellator.cut(cut), cut);
        }
    }

    #[test]
    fn whole_depths_have_powers_of_two() {
        for depth in 0..=6 {
            for backend in Backend::ALL {
                assert_eq!(backend.level_of(depth as f32), (1 << depth) as f32);
            }
        }
        assert_eq!(Backend::Pattern.level_of(2.01), 8.0);
        assert!((Backend::Tessellator.level_of(2.5) - 32f32.sqrt()).abs() < 1e-5);
    }
}
