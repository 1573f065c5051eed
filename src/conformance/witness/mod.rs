//! Group `witness`: what every surface must be, whoever computes it.
//!
//! Truth and twins share rules with what they judge: where those are wrong, all agree. So this group asks neither. A plane has its plane's
//! normal; normals stand upright on what was captured; nothing turns faster than its neighbourhood; points lie among the vertices that
//! they are made of; nothing depends on where a mesh is, how large it is, or on vertices that no face uses.
//!
//! A seeded fault spoils what was captured in the way of a fault that this suite once did not see: normals out of rounding noise at corners, a
//! normal at a corner that no pixel beside it has, positions that have lost their last places to a vertex that nobody uses.

mod corners;
mod differences;
mod drawn;
mod hull;
mod planes;
mod same;
mod sides;

use crate::conformance::meshes::{
    cornered_sheet, creased_polygons, creased_sheet, framed_polygon, open_star, star, under,
};
use crate::conformance::{Case, Check, Context, Finding, Group, models};
use crate::error::Result;
use crate::mesh::{ControlMesh, Model, Scheme, SchemeOptions, builtin};
use crate::method::{METHODS, Method, MethodOptions, Prepared};

/// The group.
pub const GROUP: Group = Group {
    name: "witness",
    about: "planes, sides, differences, hulls: what holds whoever computes it",
    cases,
    model_cases: Some(model_cases),
};

/// A rule that any surface keeps, so that it can be asked of any mesh.
struct Rule {
    name: &'static str,
    rule: &'static str,
    source: &'static str,
    /// Whether a method's surface under a scheme keeps it.
    concerns: fn(&Method, Scheme) -> bool,
    /// How methods prepare for it.
    options: fn(&Method) -> MethodOptions,
    /// Looks at a model that a method prepared, and tells how much it looked at.
    look: fn(&Context, &Subject<'_>, &mut Check) -> Result<Looked>,
}

/// What is looked at.
struct Subject<'a> {
    model: &'a Model,
    method: &'static Method,
    prepared: Prepared,
}

/// How much was looked at, and the greatest of what the rule measures.
#[derive(Clone, Copy, Debug, Default)]
struct Looked {
    count: u64,
    worst: f64,
}

impl Looked {
    fn at(&mut self, measured: f64) {
        self.count += 1;
        self.worst = self.worst.max(measured);
    }

    fn add(&mut self, other: Looked) {
        self.count += other.count;
        self.worst = self.worst.max(other.worst);
    }
}

const RULES: [&Rule; 6] = [
    &hull::RULE,
    &differences::RULE,
    &sides::RULE,
    &corners::RULE,
    &same::UNUSED,
    &same::MOVED,
];

type Make = fn() -> Result<ControlMesh>;

/// Smooth and creased, open and closed, of all kinds of faces; none with faces that cross.
const MESHES: [(&str, Make); 9] = [
    ("cube", || builtin("cube")),
    ("ngons", || builtin("ngons")),
    ("sheet", || builtin("sheet")),
    ("creased", || {
        creased_sheet(10.0, 4, SchemeOptions::default())
    }),
    ("polygons", creased_polygons),
    ("cornered", || cornered_sheet(10.0)),
    ("star_5", || star(5).build()),
    ("open_star_4", || open_star(4).build()),
    ("polygon_7", || framed_polygon(7).build()),
];

fn cases() -> Vec<Case> {
    let mut cases = planes::cases();
    cases.extend(corners::cusps());
    cases.extend(sides::windings());
    for (mesh, make) in MESHES {
        // Everything about its faces is semi-sharp, which may turn as fast as it likes.
        let of_mesh = RULES
            .into_iter()
            .filter(|rule| (rule.name, mesh) != ("corners", "ngons"));
        for rule in of_mesh {
            let name = format!("witness.{}.{mesh}", rule.name);
            cases.push(Case::new(name, rule.rule, rule.source, move |context| {
                of_all_schemes(context, rule, make)
            }));
        }
    }
    cases
}

fn model_cases(name: &str) -> Vec<Case> {
    let case = |rule: &'static Rule| {
        let model = name.to_owned();
        let name = format!("witness.{}.model_{name}", rule.name);
        Case::new(name, rule.rule, rule.source, move |context| {
            of_users(context, rule, context.model(&model)?)
        })
    };
    RULES.map(case).into()
}

/// Asks a rule of a mesh under every scheme that knows it, by every method that draws it.
fn of_all_schemes(
    context: &Context,
    rule: &Rule,
    make: impl Fn() -> Result<ControlMesh>,
) -> Result<Finding> {
    let (mut check, mut looked) = (Check::default(), Looked::default());
    for scheme in Scheme::ALL {
        let Ok(mesh) = under(make()?, scheme) else {
            continue;
        };
        let model = Model::new(mesh);
        let able = METHODS
            .iter()
            .filter(|method| method.check_model(&model).is_ok());
        for method in able.filter(|method| (rule.concerns)(method, scheme)) {
            let prepared = method.prepare(&model, (rule.options)(method))?;
            let subject = Subject {
                model: &model,
                method,
                prepared,
            };
            looked.add((rule.look)(context, &subject, &mut check)?);
        }
    }
    Ok(check.finish(words(looked)))
}

/// Asks a rule of a mesh of the user's, by every method that draws it.
fn of_users(context: &Context, rule: &Rule, model: &Model) -> Result<Finding> {
    let (mut check, mut looked) = (Check::default(), Looked::default());
    let scheme = model.mesh().options().scheme;
    let mut skipped = None;
    for method in METHODS
        .iter()
        .filter(|method| (rule.concerns)(method, scheme))
    {
        match models::prepared(model, method, (rule.options)(method)) {
            Ok(prepared) => {
                let subject = Subject {
                    model,
                    method,
                    prepared,
                };
                looked.add((rule.look)(context, &subject, &mut check)?);
            }
            Err(finding) => skipped = Some(finding),
        }
    }
    let nothing = || Finding::skip(format!("there is nothing of the kind under {scheme}"));
    Ok(match skipped {
        Some(skipped) if looked.count == 0 => skipped,
        None if looked.count == 0 && check.is_empty() => nothing(),
        _ => check.finish(words(looked)),
    })
}

fn words(looked: Looked) -> String {
    format!("{} looked at, at most {:.3e}", looked.count, looked.worst)
}

/// The methods and schemes of cases that have meshes of their own.
fn pairs() -> impl Iterator<Item = (&'static Method, Scheme)> {
    METHODS
        .iter()
        .flat_map(|method| method.schemes.iter().map(move |&scheme| (method, scheme)))
}

fn every(_: &Method, _: Scheme) -> bool {
    true
}

fn usual(_: &Method) -> MethodOptions {
    MethodOptions::default()
}
