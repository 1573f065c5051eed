//! How methods prepare: options of whatever prepares a model for drawing.

use super::Macro;
use clap::{Args, ValueEnum};
use hullform::Error;
use hullform::method::{
    EndCaps, IsolationOptions, METHODS, Method, MethodOptions, Reproduces, TableNormals,
    TableOptions,
};
use hullform::plan::PlanOptions;

/// How tables of basis functions are made, and features isolated: options of whatever prepares a model for drawing.
#[derive(Args)]
pub struct Tables {
    /// Level of tables of basis functions, 1 to 6: a patch has 2^N segments an edge [default: 5]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=6))]
    table_level: Option<u32>,
    /// Level of the refined mesh whose normals subdivision shading begins with, 0 to 2 [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=2))]
    shading_level: Option<u32>,
    /// Normals of the limit, by tables of tangents, instead of subdivision shading
    #[arg(long, conflicts_with = "shading_level")]
    geometric_normals: bool,
    /// Refinements by methods that refine, 0 to 6: around what is irregular before end caps, or everywhere; up to level 2^N all that is drawn is on the limit
    /// [default: what the level needs]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=6))]
    isolation: Option<u32>,
    /// Patches of what is still irregular after these [default: bicubic]
    #[arg(long, value_name = "KIND")]
    caps: Option<Caps>,
    #[command(flatten)]
    macro_faces: Macro,
}

/// End caps.
#[derive(Clone, Copy, ValueEnum)]
enum Caps {
    /// Bicubic patches with the limit's tangent plane at their corners
    Bicubic,
    /// Gregory patches
    Gregory,
    /// Gregory patches whose points the control shader sums in each frame
    Legacy,
    /// B-spline patches of the mesh's own vertices where only one vertex is extraordinary, else bicubic ones
    Bspline,
}

impl From<Caps> for EndCaps {
    fn from(caps: Caps) -> EndCaps {
        match caps {
            Caps::Bicubic => EndCaps::Bicubic,
            Caps::Gregory => EndCaps::Gregory,
            Caps::Legacy => EndCaps::Legacy,
            Caps::Bspline => EndCaps::Bspline,
        }
    }
}

impl Tables {
    /// What a method prepares with for some levels, of which each has the isolation that it needs, unless that is given, the method does not isolate, or a frame decides how deep.
    ///
    /// # Errors
    /// As [`Tables::options`] of `all`.
    pub fn by_isolation(
        &self,
        method: &Method,
        levels: &[f32],
        all: &[&Method],
    ) -> hullform::Result<Vec<(MethodOptions, Vec<f32>)>> {
        let mut groups: Vec<(MethodOptions, Vec<f32>)> = Vec::new();
        let greatest = levels.iter().copied().fold(1.0, f32::max);
        for &level in levels {
            let is_own = method.isolates && !method.dynamic || self.macro_faces.is_asked();
            let own = if is_own { level } else { greatest };
            let options = self.options(all, own)?;
            match groups.iter_mut().find(|(known, _)| *known == options) {
                Some((_, levels)) => levels.push(level),
                None => groups.push((options, vec![level])),
            }
        }
        Ok(groups)
    }

    /// What some methods prepare with for tess levels up to `level`.
    ///
    /// # Errors
    /// [`Error::Option`] when something is asked for that none of them uses.
    pub fn options(&self, methods: &[&Method], level: f32) -> hullform::Result<MethodOptions> {
        let mut asked = self.asked();
        if let Some((option, user)) =
            asked.find(|(_, user)| !methods.iter().any(|m| (user.uses)(m)))
        {
            return Err(useless(option, &user, methods));
        }
        let needed = || IsolationOptions::level_for(level);
        let isolation = IsolationOptions {
            level: self.isolation.unwrap_or_else(needed),
            caps: self.caps.map_or(EndCaps::default(), EndCaps::from),
        };
        let usual = PlanOptions::default();
        let plans = PlanOptions {
            max_level: usual.max_level.max(PlanOptions::level_for(level)),
            ..usual
        };
        Ok(MethodOptions {
            tables: self.tables(),
            isolation,
            plans,
            macro_faces: self.macro_faces.faces(level).check()?,
        })
    }

    /// The options that were given, and who uses them.
    pub(super) fn asked(&self) -> impl Iterator<Item = (&'static str, User)> {
        let given = [
            ("--table-level", self.table_level.is_some(), TABLES),
            ("--shading-level", self.shading_level.is_some(), TABLES),
            ("--geometric-normals", self.geometric_normals, TABLES),
            ("--isolation", self.isolation.is_some(), ISOLATION),
            ("--caps", self.caps.is_some(), CAPS),
            ("--macro", self.macro_faces.is_asked(), MACRO),
        ];
        let given = given.into_iter().filter(|(_, given, _)| *given);
        given.map(|(option, _, user)| (option, user))
    }

    fn tables(&self) -> TableOptions {
        let usual = TableOptions::default();
        let normals = match self.shading_level {
            _ if self.geometric_normals => TableNormals::Geometric,
            Some(level) => TableNormals::Shading(level),
            None => usual.normals,
        };
        TableOptions {
            level: self.table_level.unwrap_or(usual.level),
            normals,
        }
    }
}

/// Who uses an option: what the others lack, what those have that do, and which these are.
#[derive(Clone, Copy)]
pub(super) struct User {
    lack: &'static str,
    have: &'static str,
    uses: fn(&Method) -> bool,
}

const TABLES: User = User {
    lack: "no tables are used",
    have: "has tables",
    uses: |method| method.uses_tables,
};

const ISOLATION: User = User {
    lack: "nothing is refined around features",
    have: "refines",
    uses: |method| method.isolates,
};

const CAPS: User = User {
    lack: "nothing has end caps",
    have: "has end caps",
    uses: |method| matches!(method.contract.reproduces, Reproduces::LimitBesideCaps(_)),
};

const MACRO: User = User {
    lack: "no faces are drawn together",
    have: "draws faces together",
    uses: |method| method.aggregates,
};

/// An option, and methods that do not use it.
fn useless(option: &'static str, user: &User, methods: &[&Method]) -> Error {
    let names = |methods: &mut dyn Iterator<Item = &Method>| {
        let names: Vec<&str> = methods.map(|method| method.name).collect();
        names.join(", ")
    };
    let own = names(&mut methods.iter().copied());
    let users = names(&mut METHODS.iter().filter(|method| (user.uses)(method)));
    Error::Option {
        option,
        problem: format!("{} by {own}", user.lack),
        remedy: format!(
            "leave it out, or choose a method that {} ({users})",
            user.have
        ),
    }
}
