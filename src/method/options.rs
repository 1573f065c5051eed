//! How methods prepare: each takes the options that concern it.

use crate::abi;
use crate::error::{Error, Result};
use crate::method::macro_faces::MacroFaces;
use crate::plan::PlanOptions;

/// The options of all methods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MethodOptions {
    /// Of methods with plans.
    pub plans: PlanOptions,
    /// Of methods with tables of basis functions: see [`Method::uses_tables`](super::Method::uses_tables).
    pub tables: TableOptions,
    /// Of methods that refine around features: see [`Method::isolates`](super::Method::isolates).
    pub isolation: IsolationOptions,
    /// Of methods that draw several faces as one patch: see [`Method::aggregates`](super::Method::aggregates).
    pub macro_faces: MacroFaces,
}

impl From<MacroFaces> for MethodOptions {
    fn from(macro_faces: MacroFaces) -> MethodOptions {
        MethodOptions {
            macro_faces,
            ..Default::default()
        }
    }
}

impl From<PlanOptions> for MethodOptions {
    fn from(plans: PlanOptions) -> MethodOptions {
        MethodOptions {
            plans,
            ..Default::default()
        }
    }
}

impl From<IsolationOptions> for MethodOptions {
    fn from(isolation: IsolationOptions) -> MethodOptions {
        MethodOptions {
            isolation,
            ..Default::default()
        }
    }
}

impl From<TableOptions> for MethodOptions {
    fn from(tables: TableOptions) -> MethodOptions {
        MethodOptions {
            tables,
            ..Default::default()
        }
    }
}

/// How far refinement isolates what is irregular (Nießner, Loop, Meyer, DeRose 2012), and what is drawn of it then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IsolationOptions {
    /// Refinements of the control mesh around extraordinary vertices, 0..=6; what is still irregular then has an end cap. Up to tess level 2^level all
    /// vertices of caps are corners. Meshes with faces of other than four corners are refined once at least.
    pub level: u32,
    /// The patches of what is still irregular.
    pub caps: EndCaps,
}

/// The patch of a face that is irregular at the last level. All have the limit at their corners, and on edges beside B-spline patches the same curves as those. Names
/// are OpenSubdiv's (documentation, *Subdivision Surfaces*, "End caps"), but for the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum EndCaps {
    /// Bicubic patches: edges as Gregory patches have them, and inside the points of Loop, Schaefer 2008. Sixteen points.
    #[default]
    Bicubic,
    /// Gregory patches (Loop, Schaefer, Ni, Castaño 2009): one plane along edges too. Twenty points.
    Gregory,
    /// The same, whose points the control shader sums from the vertices around them in each frame, where all others come from a table that is computed once a pose.
    Legacy,
    /// B-spline patches of the mesh's own vertices around a lone extraordinary vertex inside; the one that there is none for makes the corner the limit. There
    /// the plane is not the limit's. Others are bicubic.
    Bspline,
}

impl Default for IsolationOptions {
    /// Level 3, which serves tess level 8.
    fn default() -> IsolationOptions {
        IsolationOptions {
            level: 3,
            caps: EndCaps::default(),
        }
    }
}

impl IsolationOptions {
    /// The greatest `level`.
    pub const GREATEST_LEVEL: u32 = abi::GREATEST_DEPTH;

    /// The refinements that a tess level needs: its binary logarithm. With fewer, vertices fall inside of end caps; with more, patches are cut finer than is asked for.
    pub fn level_for(tess_level: f32) -> u32 {
        let whole = tess_level.clamp(1.0, 64.0).ceil() as u32;
        whole.next_power_of_two().ilog2()
    }

    /// Checks the range.
    ///
    /// # Errors
    /// [`Error::Option`] when the level is out of range.
    pub fn check(self) -> Result<IsolationOptions> {
        if self.level <= Self::GREATEST_LEVEL {
            return Ok(self);
        }
        Err(Error::Option {
            option: "--isolation",
            problem: format!("{} is out of range", self.level),
            remedy: "give a level of 0 to 6; that of the tess level's binary logarithm is best"
                .into(),
        })
    }
}

/// How tables of basis functions are made (Holländer, Boubekeur 2011).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableOptions {
    /// The level of the lattice, 1..=6: a patch has 2^level segments an edge. Tess factors of faces, whose edges are two patches long, stay at or
    /// below 2^(level + 1).
    pub level: u32,
    /// Where normals come from.
    pub normals: TableNormals,
}

/// Where the normals of a surface from tables come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableNormals {
    /// Subdivision shading (Alexa, Boubekeur 2008) from this level on, 0..=2: vertex normals of the mesh refined so often, blended by the same
    /// weights as positions. The earlier it begins the smoother it looks.
    Shading(u32),
    /// The limit's own, from tables of tangents, which take two times the memory of those of positions besides. Where a scheme promises no tangent plane,
    /// as the butterfly at some boundary vertices, it may be up to 5 degrees from [`LimitSurface`](crate::subdivision::LimitSurface)'s, which asks the
    /// surroundings.
    Geometric,
}

impl Default for TableOptions {
    /// Level 5 and shading from level 1 on, as in the paper.
    fn default() -> TableOptions {
        TableOptions {
            level: 5,
            normals: TableNormals::Shading(1),
        }
    }
}

impl TableOptions {
    /// The greatest `level`.
    pub const GREATEST_LEVEL: u32 = 6;
    /// The latest level that shading begins at.
    pub const GREATEST_SHADING_LEVEL: u32 = 2;

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Option`] when a level is out of range.
    pub fn check(self) -> Result<TableOptions> {
        let problem = |level: u32| format!("{level} is out of range");
        if !(1..=Self::GREATEST_LEVEL).contains(&self.level) {
            return Err(Error::Option {
                option: "--table-level",
                problem: problem(self.level),
                remedy: "give a level of 1 to 6; 5 serves every tess level that is a power of two"
                    .into(),
            });
        }
        match self.normals {
            TableNormals::Shading(level) if level > Self::GREATEST_SHADING_LEVEL => {
                Err(Error::Option {
                    option: "--shading-level",
                    problem: problem(level),
                    remedy: "give 0, 1 or 2".into(),
                })
            }
            _ => Ok(self),
        }
    }
}
