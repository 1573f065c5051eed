//! Who cuts patches into triangles: the three implementations of section 3.2 of Boubekeur, Schlick 2007.

use rustc_hash::FxHashMap;

use crate::abi;
use crate::error::{Error, Misuse, Result};
use crate::frame::{Cut, Residence};
use crate::method::Prepared;
use crate::tessellation::{
    Levels, Spacing, coordinates, lattice_rows, lattice_segments, lattice_vertices, pattern,
    triangulate_levels,
};

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

/// What a back-end is, as far as it is decided without a device; `gpu/backend.rs` has the rest.
struct Row {
    name: &'static str,
    /// The greatest level that it goes to.
    greatest_level: f32,
    /// Whether it may go beyond that in pieces.
    pieces: bool,
    /// Whether levels and spacing are as they are asked for, and not powers of two, evenly.
    any_level: bool,
    /// Whether its patches may have their control points in the ring.
    ring: bool,
    /// Whether the device may decide about its patches.
    decided: bool,
    /// Whether it draws several eyes at once.
    multiview: bool,
    /// Whether a driver may bound the vertices of its instances.
    bounded: bool,
    /// Whether patches are drawn by refinement patterns, an instance each.
    patterns: bool,
    /// How often a patch is evaluated.
    evaluations: fn(&Levels, Spacing) -> u32,
    /// How many different vertices a patch has.
    vertices: fn(&Levels, Spacing) -> u32,
    /// How many triangles.
    triangles: fn(&Levels, Spacing) -> u32,
    /// Its triangles by the numbers of its vertices, which come in any order; None where these are not all.
    join: fn(&Levels, Spacing, &[[f32; 2]]) -> Option<Triangles>,
    /// Its vertices and triangles.
    mould: fn(&Levels, Spacing) -> Mould,
}

/// Three vertices each, by their numbers.
type Triangles = Vec<[u32; 3]>;

/// By the numbers of [`Backend`].
static ROWS: [Row; 3] = [
    Row {
        name: "tessellator",
        greatest_level: 64.0,
        pieces: true,
        any_level: true,
        ring: true,
        decided: true,
        multiview: true,
        bounded: true,
        patterns: false,
        evaluations: |levels, spacing| levels.vertices(spacing),
        vertices: |levels, spacing| levels.different_vertices(spacing),
        triangles: |levels, spacing| levels.triangles(spacing),
        join: |levels, spacing, uv| {
            let triangles = triangulate_levels(levels, spacing, uv);
            let expected = levels.triangles(spacing) as usize;
            (triangles.len() >= expected).then_some(triangles)
        },
        mould: |levels, spacing| {
            let uv = coordinates(levels, spacing);
            let triangles = triangulate_levels(levels, spacing, &uv);
            Mould { uv, triangles }
        },
    },
    Row {
        name: "pattern",
        patterns: true,
        evaluations: |levels, _| lattice_vertices(levels),
        ..LATTICE
    },
    Row {
        name: "geometry",
        greatest_level: abi::GEOMETRY_ROWS as f32,
        evaluations: |levels, _| lattice_rows(levels),
        ..LATTICE
    },
];

/// What those have in common that cut patches by a lattice.
const LATTICE: Row = Row {
    name: "",
    greatest_level: 64.0,
    pieces: false,
    any_level: false,
    ring: false,
    decided: false,
    multiview: false,
    bounded: false,
    patterns: false,
    evaluations: |levels, _| lattice_vertices(levels),
    vertices: |levels, _| lattice_vertices(levels),
    triangles: |levels, _| pattern(levels).len() as u32,
    join: join_lattice,
    mould: lattice_mould,
};

/// What patches at the same levels have in common.
pub(super) struct Mould {
    /// Where their vertices are.
    pub uv: Vec<[f32; 2]>,
    /// Three of these each.
    pub triangles: Vec<[u32; 3]>,
}

fn join_lattice(levels: &Levels, _: Spacing, uv: &[[f32; 2]]) -> Option<Triangles> {
    let segments = lattice_segments(levels) as f32;
    let place = |at: &[f32; 2]| at.map(|x| (x * segments) as u32);
    let numbers: FxHashMap<[u32; 2], u32> = uv.iter().map(place).zip(0..).collect();
    let numbered = |places: [[u32; 2]; 3]| {
        let [a, b, c] = places.map(|place| numbers.get(&place).copied());
        Some([a?, b?, c?])
    };
    pattern(levels).into_iter().map(numbered).collect()
}

fn lattice_mould(levels: &Levels, _: Spacing) -> Mould {
    let segments = lattice_segments(levels) as f32;
    let triangles = pattern(levels);
    let mut places: Vec<[u32; 2]> = triangles.iter().flatten().copied().collect();
    places.sort_unstable_by_key(|&[i, j]| [j, i]);
    places.dedup();
    let number = |[i, j]: [u32; 2]| {
        let found = places.binary_search_by_key(&[j, i], |&[i, j]| [j, i]);
        found.expect("every triangle's places are among them") as u32
    };
    Mould {
        uv: places
            .iter()
            .map(|at| at.map(|x| x as f32 / segments))
            .collect(),
        triangles: triangles
            .iter()
            .map(|corners| corners.map(number))
            .collect(),
    }
}

impl Backend {
    /// All.
    pub const ALL: [Backend; 3] = [Backend::Tessellator, Backend::Pattern, Backend::Geometry];

    fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// The greatest level that it cuts a patch to at once.
    pub fn greatest_level(self) -> f32 {
        self.row().greatest_level
    }

    /// Whether levels and spacing are as they are asked for; else levels are raised to powers of two, and spaced evenly.
    pub fn takes_any_level(self) -> bool {
        self.row().any_level
    }

    /// Whether its patches may have their control points in the ring.
    pub fn takes_ring(self) -> bool {
        self.row().ring
    }

    /// Whether it draws several eyes at once, by multiview.
    pub fn takes_multiview(self) -> bool {
        self.row().multiview
    }

    /// Whether the device may decide about its patches.
    pub(super) fn is_decided(self) -> bool {
        self.row().decided
    }

    /// Whether a driver may bound the vertices of its instances.
    pub(super) fn is_bounded(self) -> bool {
        self.row().bounded
    }

    /// Whether patches are drawn by refinement patterns.
    pub(crate) fn has_patterns(self) -> bool {
        self.row().patterns
    }

    /// A cut as it will be.
    pub fn cut(self, cut: Cut) -> Cut {
        if self.takes_any_level() {
            return cut;
        }
        Cut {
            level: (cut.level.clamp(1.0, 1024.0).ceil() as u32).next_power_of_two() as f32,
            spacing: Spacing::Equal,
        }
    }

    /// The level of a depth: whole depths have powers of two, to the last bit.
    pub(crate) fn level_of(self, depth: f32) -> f32 {
        if !self.takes_any_level() {
            return (1u32 << depth.ceil() as u32) as f32;
        }
        let whole = depth.floor();
        (1u32 << whole as u32) as f32 * (depth - whole).exp2()
    }

    /// How many vertices the evaluating shader captures of a patch, each run of it counted.
    pub(crate) fn evaluations(self, levels: &Levels, spacing: Spacing) -> u32 {
        (self.row().evaluations)(levels, spacing)
    }

    /// How many different vertices a patch has.
    pub(super) fn vertices(self, levels: &Levels, spacing: Spacing) -> u32 {
        (self.row().vertices)(levels, spacing)
    }

    /// How many triangles a patch has.
    pub(super) fn triangles(self, levels: &Levels, spacing: Spacing) -> u32 {
        (self.row().triangles)(levels, spacing)
    }

    /// The triangles of a patch by the numbers of its vertices, which come in any order; None where these are not all.
    pub(super) fn join(
        self,
        levels: &Levels,
        spacing: Spacing,
        uv: &[[f32; 2]],
    ) -> Option<Vec<[u32; 3]>> {
        (self.row().join)(levels, spacing, uv)
    }

    /// The vertices and triangles of a patch.
    pub(super) fn mould(self, levels: &Levels, spacing: Spacing) -> Mould {
        (self.row().mould)(levels, spacing)
    }

    /// Whether it can draw what was prepared, at up to `level`.
    ///
    /// # Errors
    /// [`Misuse::BackendWithoutRing`] and [`Misuse::BackendLevel`] when it cannot.
    pub fn check(self, prepared: &Prepared, residence: Residence, level: f32) -> Result<()> {
        let mut passes = prepared.passes.iter();
        let ring = residence == Residence::Ring;
        let backend = self.name();
        if !self.takes_ring() && ring && passes.any(|pass| !pass.scratch_points.is_empty()) {
            return Err(Error::Misuse(Misuse::BackendWithoutRing { backend }));
        }
        let cut = Cut {
            level,
            spacing: Spacing::Equal,
        };
        let greatest = match self.row().pieces {
            true => Spacing::Equal.greatest(),
            false => self.greatest_level(),
        };
        if self.cut(cut).level > greatest {
            return Err(Error::Misuse(Misuse::BackendLevel { backend, greatest }));
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
    fn rows_stand_in_the_order_of_the_numbers() {
        let names = Backend::ALL.map(Backend::name);
        assert_eq!(names, ["tessellator", "pattern", "geometry"]);
        assert_eq!(Backend::ALL.map(|backend| backend as usize), [0, 1, 2]);
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
