//! How methods prepare: each takes the options that concern it.

use crate::error::{Error, Result};
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

/// How far refinement isolates what is irregular (Nießner, Loop, Meyer, DeRose 2012).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IsolationOptions {
    /// Refinements of the control mesh around extraordinary vertices, 1..=6; what is still irregular then has an end cap. Up to tess level 2^level all
    /// vertices of caps are corners.
    pub level: u32,
}

impl Default for IsolationOptions {
    /// Level 3, which serves tess level 8.
    fn default() -> IsolationOptions {
        IsolationOptions { level: 3 }
    }
}

impl IsolationOptions {
    /// The greatest `level`.
    pub const GREATEST_LEVEL: u32 = 6;

    /// Checks the range.
    ///
    /// # Errors
    /// [`Error::Option`] when the level is out of range.
    pub fn check(self) -> Result<IsolationOptions> {
        if (1..=Self::GREATEST_LEVEL).contains(&self.level) {
            return Ok(self);
        }
        Err(Error::Option {
            option: "--isolation",
            problem: format!("{} is out of range", self.level),
            remedy: "give a level of 1 to 6; that of the tess level's binary logarithm is best"
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
