//! Group `coordinates`: the rules on tess coordinates, for three domains and three spacings, at ninety levels.
//!
//! Vertices come in no order and possibly several times, so sets are compared. A seeded fault gives the device other levels than the
//! reference is told.

mod construction;
mod reference;
mod rules;
mod shot;

use crate::conformance::modes::{Domain, Modes, Spacing};
use crate::conformance::{Case, Context, Finding, Group};
use crate::error::Result;

pub use reference::{TessLevels, segments, vertex_count};
pub use shot::{Shot, shoot, shoot_with};

/// The group.
pub const GROUP: Group = Group {
    name: "coordinates",
    about: "where the tessellator puts vertices",
    cases,
    model_cases: None,
};

/// A rule for one domain and spacing.
struct Rule {
    name: &'static str,
    rule: &'static str,
    source: &'static str,
    check: fn(&Context, Modes) -> Result<Finding>,
    /// Whether it says something about the spacing.
    concerns: fn(Modes) -> bool,
}

fn all(_: Modes) -> bool {
    true
}

fn areas(modes: Modes) -> bool {
    modes.domain != Domain::Isolines
}

const RULES: [Rule; 13] = [
    Rule {
        name: "sets",
        rule: "the vertices of a patch are those that its levels construct",
        source: "Vulkan, Triangle, Quad and Isoline Tessellation",
        check: construction::sets,
        concerns: all,
    },
    Rule {
        name: "mixed_sets",
        rule: "the same when all levels of a patch differ",
        source: "Vulkan, Triangle, Quad and Isoline Tessellation",
        check: construction::mixed_sets,
        concerns: all,
    },
    Rule {
        name: "counts",
        rule: "an edge has the segments of its level rounded up, and more for higher levels",
        source: "Vulkan, Tessellator Spacing",
        check: rules::counts,
        concerns: all,
    },
    Rule {
        name: "lengths",
        rule: "all segments of an edge are equal, but for two of fractional spacing, which lie symmetrically and grow with the level",
        source: "Vulkan, Tessellator Spacing",
        check: rules::lengths,
        concerns: all,
    },
    Rule {
        name: "symmetry",
        rule: "with a vertex at x an edge has one at exactly 1 - x",
        source: "Vulkan, Tessellation Invariance, rule 3",
        check: rules::symmetry,
        concerns: all,
    },
    Rule {
        name: "any_edge",
        rule: "edges of one level have the same vertices, whichever edge it is",
        source: "Vulkan, Tessellation Invariance, rule 4",
        check: rules::any_edge,
        concerns: areas,
    },
    Rule {
        name: "outer_alone",
        rule: "an outer edge's vertices depend on its own level alone",
        source: "Vulkan, Tessellation Invariance, rule 2",
        check: rules::outer_alone,
        concerns: all,
    },
    Rule {
        name: "inner_alone",
        rule: "vertices inside depend on the inner levels alone",
        source: "Vulkan, Tessellation Invariance, rule 6",
        check: rules::inner_alone,
        concerns: areas,
    },
    Rule {
        name: "repeated",
        rule: "the same levels give the same vertices in any patch of any draw",
        source: "Vulkan, Tessellation Invariance, rule 1",
        check: rules::repeated,
        concerns: all,
    },
    Rule {
        name: "exact",
        rule: "coordinates lie in 0..1, 1 - x is exact, and corners are exactly 0 and 1",
        source: "Vulkan, Tessellation Invariance, rule 8",
        check: rules::exact,
        concerns: all,
    },
    Rule {
        name: "winding",
        rule: "clockwise patches have the same vertices and show their other side",
        source: "Vulkan, Tessellation Invariance, rule 5",
        check: rules::winding,
        concerns: areas,
    },
    Rule {
        name: "points",
        rule: "in point mode each vertex comes once, and they are the same ones",
        source: "Vulkan, Tessellator Point Mode",
        check: rules::points,
        concerns: all,
    },
    Rule {
        name: "clamped",
        rule: "levels beyond the device's greatest, and below the least, count as these",
        source: "Vulkan, Tessellator Spacing",
        check: rules::clamped,
        concerns: all,
    },
];

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (domain, spacing) in Domain::ALL
        .into_iter()
        .flat_map(|domain| Spacing::ALL.map(|spacing| (domain, spacing)))
    {
        let modes = Modes::new(domain, spacing);
        for rule in RULES.iter().filter(|rule| (rule.concerns)(modes)) {
            let name = format!(
                "coordinates.{}-{}.{}",
                domain.name(),
                spacing.name(),
                rule.name
            );
            let check = rule.check;
            cases.push(Case::new(name, rule.rule, rule.source, move |context| {
                check(context, modes)
            }));
        }
    }
    cases
}
