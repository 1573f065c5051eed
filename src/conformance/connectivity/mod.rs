//! Group `connectivity`: how the tessellator joins its vertices, as a geometry shader sees it, as transform feedback captures it, and as a picture.
//!
//! Which diagonal a strip takes is the implementation's. That triangles cover the domain and do not overlap, how many there are, and what they may
//! not depend on, is the specification's. A seeded fault loses a triangle, or gives the patch that is compared with another inner level.

mod caught;
mod feedback;
mod fill;

use std::collections::{BTreeMap, BTreeSet};

pub use feedback::twice as captured_twice;

use caught::{Bits, Caught, Primitive, primitives};

use crate::conformance::coordinates::{TessLevels, segments, vertex_count};
use crate::conformance::modes::{Domain, Modes, Spacing};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "connectivity",
    about: "triangles and lines as the tessellator joins them",
    cases,
    model_cases: None,
};

/// Kinds of levels.
#[derive(Clone, Copy)]
struct Table {
    name: &'static str,
    /// Inner and outer levels lie between these.
    inner: (f64, f64),
    outer: (f64, f64),
    whole: bool,
    patches: u32,
}

const TABLES: [Table; 10] = [
    table("whole-few", (1.0, 4.0), (1.0, 4.0), true, 20),
    table("whole-some", (1.0, 16.0), (1.0, 16.0), true, 10),
    table("whole-many", (20.0, 64.0), (20.0, 64.0), true, 3),
    table("between-few", (1.0, 4.0), (1.0, 4.0), false, 20),
    table("between-some", (1.0, 16.0), (1.0, 16.0), false, 10),
    table("between-many", (20.0, 63.0), (20.0, 63.0), false, 3),
    table("inner-one", (1.0, 1.0), (1.0, 12.0), true, 10),
    table("outer-one", (2.0, 12.0), (1.0, 1.0), true, 10),
    table("inner-many", (30.0, 64.0), (1.0, 5.0), false, 4),
    table("outer-many", (1.0, 5.0), (30.0, 64.0), false, 4),
];

const fn table(
    name: &'static str,
    inner: (f64, f64),
    outer: (f64, f64),
    whole: bool,
    patches: u32,
) -> Table {
    Table {
        name,
        inner,
        outer,
        whole,
        patches,
    }
}

impl Table {
    fn levels(&self, context: &Context) -> Vec<TessLevels> {
        let mut random = context.random(self.name);
        let mut level = |(low, high): (f64, f64)| {
            if self.whole {
                low as f32 + random.below((high - low) as u32 + 1) as f32
            } else {
                random.between(low, high) as f32
            }
        };
        let patches = 0..self.patches;
        patches
            .map(|_| TessLevels {
                outer: [(); 4].map(|()| level(self.outer)),
                inner: [(); 2].map(|()| level(self.inner)),
            })
            .collect()
    }
}

/// A kind of patches.
#[derive(Clone, Copy)]
struct Subject {
    modes: Modes,
    table: Table,
}

impl Subject {
    /// What is lost on purpose is the last primitive of every patch.
    fn caught(&self, context: &Context, levels: &[TessLevels]) -> Result<Caught> {
        let mut caught = primitives(context, self.modes, levels)?;
        if context.is_wrong() {
            caught
                .iter_mut()
                .for_each(|patch| patch.truncate(patch.len().saturating_sub(1)));
        }
        Ok(caught)
    }

    /// Where an inner level of 1 becomes a hair more, nobody says how much: vertices may coincide there.
    fn is_barely_divided(&self, levels: &TessLevels) -> bool {
        let inner = levels.inner(self.modes.domain);
        self.modes.spacing == Spacing::FractionalOdd && inner.iter().any(|&level| level <= 1.0)
    }
}

fn place(bits: Bits) -> [f64; 2] {
    [0, 1].map(|i| f64::from(f32::from_bits(bits[i])))
}

/// Twice the signed area, positive where (u, v) turns like u to v.
fn area(triangle: &Primitive) -> f64 {
    let [[ax, ay], [bx, by], [cx, cy]] = triangle.map(place);
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// Areas sum to the domain's, and none is turned over: so nothing is covered twice, and nothing is missing.
fn cover(context: &Context, subject: Subject) -> Result<Finding> {
    let levels = subject.table.levels(context);
    let mut check = Check::default();
    let mut count = 0;
    let (whole, tolerance) = match subject.modes.domain {
        Domain::Quads => (2.0, 1e-9),
        // u + v = 1 along the third edge but for rounding.
        _ => (1.0, 1e-4),
    };
    // Counter-clockwise in a domain whose v points down.
    let sign = if subject.modes.clockwise { 1.0 } else { -1.0 };
    for (levels, triangles) in levels.iter().zip(subject.caught(context, &levels)?) {
        count += triangles.len();
        let areas: Vec<f64> = triangles.iter().map(|t| sign * area(t)).collect();
        let sum: f64 = areas.iter().sum();
        check.hold((sum - whole).abs() <= tolerance, || {
            format!("{levels:?}: areas sum to {} of the domain", sum / whole)
        });
        // Thin ones inside of triangles may be turned by rounding.
        let turned = areas.iter().filter(|&&area| area < -1e-7).count();
        check.hold(turned == 0, || {
            format!("{levels:?}: {turned} triangles are turned over")
        });
    }
    Ok(check.finish(format!("{count} triangles")))
}

/// Each side of a triangle is one of another in the other direction, or lies on the domain's border.
fn sides(context: &Context, subject: Subject) -> Result<Finding> {
    let levels = subject.table.levels(context);
    let mut check = Check::default();
    let mut count = 0;
    for (levels, triangles) in levels.iter().zip(subject.caught(context, &levels)?) {
        let mut sides: BTreeMap<(Bits, Bits), i32> = BTreeMap::new();
        for [a, b, c] in &triangles {
            for (from, to) in [(a, b), (b, c), (c, a)]
                .into_iter()
                .filter(|(from, to)| from != to)
            {
                *sides.entry((*from, *to)).or_default() += 1;
            }
        }
        // Sides of triangles without area cancel each other.
        let barely = subject.is_barely_divided(levels);
        for (&(from, to), &times) in &sides {
            let back = sides.get(&(to, from)).copied().unwrap_or_default();
            let open = times - back;
            let right = if on_border(subject.modes.domain, from, to) {
                open.abs() == 1 || barely && open == 0
            } else {
                open == 0 && (times == 1 || barely)
            };
            check.hold(right, || {
                let [from, to] = [from, to].map(place);
                format!("{levels:?}: the side from {from:?} to {to:?} is there {times} times, and {back} times backwards")
            });
        }
        count += sides.len();
    }
    Ok(check.finish(format!("{count} sides")))
}

fn on_border(domain: Domain, a: Bits, b: Bits) -> bool {
    let (zero, one) = (0f32.to_bits(), 1f32.to_bits());
    match domain {
        Domain::Quads => (0..2).any(|i| a[i] == b[i] && [zero, one].contains(&a[i])),
        _ => (0..3).any(|i| a[i] == zero && b[i] == zero),
    }
}

/// By Euler's formula a disc of V vertices, B of them on its border, has 2 V - 2 - B triangles.
fn count(context: &Context, subject: Subject) -> Result<Finding> {
    let levels = subject.table.levels(context);
    let most = context.device()?.limits().max_tessellation_generation_level as f32;
    let mut check = Check::default();
    let mut count = 0;
    let Modes {
        domain, spacing, ..
    } = subject.modes;
    for (levels, triangles) in levels.iter().zip(subject.caught(context, &levels)?) {
        let outer = levels.outer(domain).iter();
        let border: u32 = outer.map(|&level| segments(spacing, level, most)).sum();
        let vertices = vertex_count(domain, spacing, levels, most);
        let right = 2 * vertices - 2 - border as usize;
        let found = triangles.len();
        let fewer = subject.is_barely_divided(levels) && found < right;
        check.hold(found == right || (fewer && !context.is_wrong()), || {
            format!("{levels:?}: {found} triangles instead of {right}")
        });
        count += found;
    }
    Ok(check.finish(format!("{count} triangles")))
}

/// A triangle whatever vertex it begins with, and whatever way round it is.
fn sorted(triangles: &[Primitive]) -> BTreeSet<Primitive> {
    let sort = |triangle: &Primitive| {
        let mut triangle = *triangle;
        triangle.sort_unstable();
        triangle
    };
    triangles.iter().map(sort).collect()
}

/// What two patches that differ in something must have in common.
fn same(
    context: &Context,
    subject: Subject,
    differ: impl Fn(&mut Modes, &mut TessLevels),
    keep: impl Fn(&Primitive, &TessLevels) -> bool,
) -> Result<Finding> {
    let mut levels = subject.table.levels(context);
    let caught = primitives(context, subject.modes, &levels)?;
    let first = levels.clone();
    let mut modes = subject.modes;
    for levels in &mut levels {
        differ(&mut modes, levels);
        if context.is_wrong() {
            levels.inner = levels.inner.map(|level| 1.5 * level + 2.0);
        }
    }
    let others = primitives(context, modes, &levels)?;
    let mut check = Check::default();
    let mut count = 0;
    for ((levels, a), b) in first.iter().zip(&caught).zip(&others) {
        let [a, b] = [a, b].map(|triangles| {
            let kept = triangles.iter().copied().filter(|t| keep(t, levels));
            sorted(&kept.collect::<Vec<_>>())
        });
        count += a.len();
        let different = a.symmetric_difference(&b).count();
        check.hold(different == 0, || {
            format!("{levels:?}: {different} of {} triangles differ", a.len())
        });
    }
    Ok(check.finish(format!("{count} triangles")))
}

/// Whether a vertex lies on an outer edge: u, v, w = 0, or of quads u = 0, v = 0, u = 1, v = 1.
fn on_edge(domain: Domain, vertex: Bits, edge: usize) -> bool {
    match (domain, edge) {
        (Domain::Quads, 2..) => vertex[edge - 2] == 1f32.to_bits(),
        _ => vertex[edge] == 0,
    }
}

fn touches(domain: Domain, triangle: &Primitive, edges: std::ops::Range<usize>) -> bool {
    edges
        .into_iter()
        .any(|edge| triangle.iter().any(|&vertex| on_edge(domain, vertex, edge)))
}

fn edges(domain: Domain) -> usize {
    if domain == Domain::Quads { 4 } else { 3 }
}

/// Rule 5: the order of vertices is no matter.
fn order(context: &Context, subject: Subject) -> Result<Finding> {
    let clockwise = !subject.modes.clockwise;
    same(
        context,
        subject,
        |modes, _| modes.clockwise = clockwise,
        |_, _| true,
    )
}

/// Rule 6: triangles that touch no outer edge do not depend on outer levels.
fn inside(context: &Context, subject: Subject) -> Result<Finding> {
    let domain = subject.modes.domain;
    let differ = |_: &mut Modes, levels: &mut TessLevels| {
        levels.outer = levels.outer.map(|level| (level * 1.7 + 1.0).min(64.0));
    };
    same(context, subject, differ, |t, _| {
        !touches(domain, t, 0..edges(domain))
    })
}

/// Rule 7: triangles that touch one outer edge alone depend on no other's level.
fn beside(context: &Context, subject: Subject) -> Result<Finding> {
    let domain = subject.modes.domain;
    let differ = |_: &mut Modes, levels: &mut TessLevels| {
        for level in &mut levels.outer[1..] {
            *level = (*level * 1.7 + 1.0).min(64.0);
        }
    };
    same(context, subject, differ, |t, _| {
        touches(domain, t, 0..1) && !touches(domain, t, 1..edges(domain))
    })
}

/// Lines of equal spacing in v, each joined from u = 0 to u = 1.
fn lines(context: &Context, subject: Subject) -> Result<Finding> {
    let levels = subject.table.levels(context);
    let most = context.device()?.limits().max_tessellation_generation_level as f32;
    let mut check = Check::default();
    let mut count = 0;
    for (levels, lines) in levels.iter().zip(subject.caught(context, &levels)?) {
        let number = segments(Spacing::Equal, levels.outer[0], most) as usize;
        let pieces = segments(subject.modes.spacing, levels.outer[1], most) as usize;
        let mut chains: BTreeMap<u32, BTreeMap<u32, u32>> = BTreeMap::new();
        for [a, b, _] in &lines {
            check.hold(a[1] == b[1], || format!("{levels:?}: a line leaves its v"));
            let chain = chains.entry(a[1]).or_default();
            let again = chain.insert(a[0].min(b[0]), a[0].max(b[0]));
            check.hold(again.is_none(), || {
                format!("{levels:?}: two lines begin at one vertex")
            });
        }
        check.hold(
            lines.len() == number * pieces && chains.len() == number,
            || {
                let (found, right) = (lines.len(), number * pieces);
                format!(
                    "{levels:?}: {found} pieces of {} lines instead of {right} of {number}",
                    chains.len()
                )
            },
        );
        let whole = |chain: &BTreeMap<u32, u32>| {
            let mut at = 0;
            let steps = std::iter::from_fn(|| {
                at = *chain.get(&at)?;
                Some(at)
            });
            let steps: Vec<u32> = steps.take(chain.len()).collect();
            steps.len() == chain.len() && steps.last() == Some(&1f32.to_bits())
        };
        check.hold(chains.values().all(whole), || {
            format!("{levels:?}: a line does not go from u = 0 to u = 1")
        });
        count += lines.len();
    }
    Ok(check.finish(format!("{count} pieces")))
}

const TESSELLATOR: &str =
    "Vulkan, Tessellator: Triangle Tessellation, Quad Tessellation, Isoline Tessellation";
const INVARIANCE: &str = "Vulkan, Invariance, Tessellation Invariance";

type Rule = (
    &'static str,
    &'static str,
    &'static str,
    fn(&Context, Subject) -> Result<Finding>,
);

const FEEDBACK: &str = "Vulkan, Transform Feedback; Transform Feedback Queries";

const RULES: [Rule; 9] = [
    (
        "cover",
        "triangles cover the domain, all in the same order, and do not overlap",
        TESSELLATOR,
        cover,
    ),
    (
        "sides",
        "each side of a triangle is that of one other, or lies on the border",
        TESSELLATOR,
        sides,
    ),
    (
        "count",
        "there are as many triangles as the levels construct",
        TESSELLATOR,
        count,
    ),
    (
        "order",
        "the order of vertices changes no triangle",
        INVARIANCE,
        order,
    ),
    (
        "inside",
        "triangles that touch no outer edge do not depend on outer levels",
        INVARIANCE,
        inside,
    ),
    (
        "beside",
        "triangles beside an outer edge do not depend on the levels of others",
        INVARIANCE,
        beside,
    ),
    (
        "fill",
        "each pixel of the domain is drawn by one triangle",
        "Vulkan, Basic Polygon Rasterization: a sample on a shared edge belongs to one polygon",
        |context, subject| fill::once(context, subject.modes, &subject.table.levels(context)),
    ),
    FEEDBACK_SAME,
    FEEDBACK_FULL,
];

const FEEDBACK_SAME: Rule = (
    "feedback",
    "transform feedback captures what a geometry shader sees, and its query counts that",
    FEEDBACK,
    |context, subject| feedback::same(context, subject.modes, &subject.table.levels(context)),
);

const FEEDBACK_FULL: Rule = (
    "feedback_room",
    "where there is no room, whole primitives are captured as far as they fit, and all are counted",
    FEEDBACK,
    |context, subject| feedback::full(context, subject.modes, &subject.table.levels(context)),
);

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (spacing, table) in Spacing::ALL
        .into_iter()
        .flat_map(|spacing| TABLES.map(|table| (spacing, table)))
    {
        let mut add = |rule: Rule, domain: Domain| {
            let (subgroup, rule, source, run) = rule;
            let modes = Modes::new(domain, spacing);
            let subject = Subject { modes, table };
            let name = format!(
                "connectivity.{subgroup}.{}-{}-{}",
                domain.name(),
                spacing.name(),
                table.name
            );
            cases.push(Case::new(name, rule, source, move |context| {
                if !context.device()?.info().support.optional.geometry_shader {
                    return Ok(Finding::skip("the device has no geometryShader"));
                }
                run(context, subject)
            }));
        };
        for rule in RULES {
            add(rule, Domain::Quads);
            add(rule, Domain::Triangles);
        }
        let rule = "lines are spaced equally, and each is joined from end to end";
        add(("lines", rule, TESSELLATOR, lines), Domain::Isolines);
        add(FEEDBACK_SAME, Domain::Isolines);
        add(FEEDBACK_FULL, Domain::Isolines);
    }
    cases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_have_a_sign() {
        let at = |u: f32, v: f32| [u.to_bits(), v.to_bits(), 0];
        let triangle = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
        assert_eq!(area(&triangle), 1.0);
        let [a, b, c] = triangle;
        assert_eq!(area(&[a, c, b]), -1.0);
        assert_eq!(sorted(&[[a, c, b]]), sorted(&[[b, c, a]]));
    }
}
