//! Group `winding`: which side of a triangle is its front, and what culling leaves.
//!
//! The order of a triangle's vertices is that of the evaluation shader, as seen in a domain whose origin is its upper left corner, or its lower left one, where the same
//! order is seen from the other side. Positions are tess coordinates, so that a domain with its origin above is seen as it is. Lines and points
//! have no order and are never culled. A seeded fault expects the other order.

use ash::vk;

use crate::conformance::coordinates::TessLevels;
use crate::conformance::modes::{Domain, Modes, Spacing, module};
use crate::conformance::raw::{Program, Raster, Raw};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;

/// The group.
pub const GROUP: Group = Group {
    name: "winding",
    about: "fronts of triangles, and culling",
    cases,
    model_cases: None,
};

/// The picture's side in pixels.
const SIDE: u32 = 64;

const CULLS: [(vk::CullModeFlags, &str); 4] = [
    (vk::CullModeFlags::NONE, "none"),
    (vk::CullModeFlags::FRONT, "front"),
    (vk::CullModeFlags::BACK, "back"),
    (vk::CullModeFlags::FRONT_AND_BACK, "both"),
];

const FRONTS: [(vk::FrontFace, &str); 2] = [
    (vk::FrontFace::COUNTER_CLOCKWISE, "ccw"),
    (vk::FrontFace::CLOCKWISE, "cw"),
];

const ORIGINS: [(vk::TessellationDomainOrigin, &str); 2] = [
    (vk::TessellationDomainOrigin::UPPER_LEFT, "upper"),
    (vk::TessellationDomainOrigin::LOWER_LEFT, "lower"),
];

/// A pipeline.
#[derive(Clone, Copy)]
struct View {
    modes: Modes,
    origin: vk::TessellationDomainOrigin,
    front: vk::FrontFace,
    cull: vk::CullModeFlags,
}

impl View {
    fn has_triangles(&self) -> bool {
        self.modes.domain != Domain::Isolines && !self.modes.points
    }

    /// Whether the triangles are seen from their front. Where there is no side, it is the front (Vulkan, Built-In Variables, FrontFacing).
    fn shows_front(&self, other_order: bool) -> bool {
        if !self.has_triangles() {
            return !other_order;
        }
        let clockwise = self.modes.clockwise != other_order;
        let from_behind = self.origin == vk::TessellationDomainOrigin::LOWER_LEFT;
        let seen_clockwise = clockwise != from_behind;
        seen_clockwise == (self.front == vk::FrontFace::CLOCKWISE)
    }

    fn is_culled(&self, front: bool) -> bool {
        let side = if front {
            vk::CullModeFlags::FRONT
        } else {
            vk::CullModeFlags::BACK
        };
        self.has_triangles() && self.cull.contains(side)
    }
}

/// What `glsl/conformance/facing.frag` draws.
const FRONT: u32 = 1;
const BACK: u32 = 2;

/// Levels whose triangles have all shapes, and all of which are seen.
const LEVELS: [f32; 2] = [1.0, 5.0];

fn seen(context: &Context, view: View) -> Result<Finding> {
    let mut check = Check::default();
    let mut pixels = [0; 2];
    let front = view.shows_front(context.is_wrong());
    let (colour, culled) = (if front { FRONT } else { BACK }, view.is_culled(front));
    for level in LEVELS {
        let table = [TessLevels::uniform(level)];
        let sizes = [size_of_val(&table) as u64, 4];
        let mut raw = Raw::new(context.device()?, &sizes, SIDE)?;
        raw.write(0, &table)?;
        let evaluation = view.modes.rewrite(module("coordinates.tese")?);
        let pipeline = raw.pipeline(&Program {
            fragment: module("facing.frag")?,
            raster: Raster::Culled(view.cull, view.front),
            origin: view.origin,
            ..Program::new(module("coordinates.tesc")?, evaluation)?
        })?;
        raw.submit(None, |cmd| {
            // No room: coordinates are counted and not kept.
            cmd.bind(pipeline, &0u32);
            cmd.draw(1, 1, 0, 0);
        })?;
        context.saw(raw.words(1)[0].into());
        let drawn: Vec<u32> = raw.pixels().into_iter().filter(|&p| p != 0).collect();
        for side in [FRONT, BACK] {
            pixels[side as usize - 1] += drawn.iter().filter(|&&p| p == side).count();
        }
        let all = (SIDE * SIDE) as usize;
        let least = match view.modes.domain {
            _ if culled => 0,
            // Points in corners may lie outside of every pixel.
            _ if !view.has_triangles() => usize::from(level > 1.0),
            Domain::Quads => all,
            _ => all * 2 / 5,
        };
        check.hold(
            drawn.len() >= least && (!culled || drawn.is_empty()),
            || {
                let wanted = if culled { "none" } else { "all" };
                format!(
                    "level {level}: {} pixels are drawn where {wanted} should be",
                    drawn.len()
                )
            },
        );
        check.hold(drawn.iter().all(|&pixel| pixel == colour), || {
            let side = if front { "the front" } else { "the back" };
            format!("level {level}: what is drawn is not {side}")
        });
    }
    let [fronts, backs] = pixels;
    Ok(check.finish(format!("{fronts} pixels of fronts, {backs} of backs")))
}

/// So many slivers, a row of pixels each, and below them a triangle that may reach out of the picture.
const SLIVERS: u32 = 56;

/// A triangle along a row of pixels, some hundredths of a pixel high, whose middle is nearly on the line between its ends: rounded to what rasterisers tell apart, some
/// show their other side. Each second one is the mirror image of the one before. In clip space.
fn sliver(row: u32) -> [[f32; 2]; 3] {
    // Each within a 64th of a pixel.
    let side = if row.is_multiple_of(2) { 1.0 } else { -1.0 };
    let spread = |step: f64| side * (2.0 * (f64::from(row / 2 + 1) * step).fract() - 1.0) / 64.0;
    let [begin, end, away] = [0.732_051, 0.618_034, 0.414_214].map(spread);
    let at = |x: f64, off: f64| {
        let [x, y] = [x, f64::from(row) + 0.5 + off].map(|t| 2.0 * t / f64::from(SIDE) - 1.0);
        [x as f32, y as f32]
    };
    let middle = at(25.5, (begin + end) / 2.0 + away / 4.0);
    [at(10.5, begin), at(40.5, end), middle]
}

/// Facings of pixels where slivers are drawn in one draw with another triangle, that is clipped if so, and what culling leaves.
fn culled_slivers(context: &Context, cull: vk::CullModeFlags, is_clipped: bool) -> Result<Finding> {
    let left = if is_clipped { -9.0 } else { -0.9 };
    let beside = [[left, 0.9], [0.9, 0.9], [0.9, 0.98]];
    let corners: Vec<[f32; 2]> = (0..SLIVERS).flat_map(sliver).chain(beside).collect();
    let sizes = [size_of_val(&corners[..]) as u64];
    let mut raw = Raw::new(context.device()?, &sizes, SIDE)?;
    raw.write(0, &corners)?;
    let mut drawn = |cull| {
        let pipeline = raw.pipeline(&Program {
            fragment: module("facing.frag")?,
            raster: Raster::Culled(cull, vk::FrontFace::COUNTER_CLOCKWISE),
            ..Program::new(module("corners.tesc")?, module("corners.tese")?)?
        })?;
        raw.submit(None, |cmd| {
            cmd.bind(pipeline, &0u32);
            cmd.draw(SLIVERS + 1, 1, 0, 0);
        })?;
        Ok(raw.pixels())
    };
    let (all, left) = (drawn(vk::CullModeFlags::NONE)?, drawn(cull)?);
    context.saw(u64::from(SLIVERS) + 1);
    let is_back = (cull == vk::CullModeFlags::BACK) != context.is_wrong();
    let culled = if is_back { BACK } else { FRONT };
    let mut check = Check::default();
    for (pixel, (&all, &left)) in all.iter().zip(&left).enumerate() {
        let right = if all == culled { 0 } else { all };
        check.hold(left == right, || {
            let [x, y] = [pixel as u32 % SIDE, pixel as u32 / SIDE];
            format!("pixel {x}, {y} is {left} instead of {right}: 1 for a front, 2 for a back")
        });
    }
    let count = |side| all.iter().filter(|&&pixel| pixel == side).count();
    Ok(check.finish(format!(
        "{} pixels of fronts, {} of backs",
        count(FRONT),
        count(BACK)
    )))
}

const SOURCE: &str = "Vulkan, Tessellator, and Basic Polygon Rasterization";

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (domain, spacing) in Domain::ALL
        .into_iter()
        .flat_map(|domain| Spacing::ALL.map(|spacing| (domain, spacing)))
    {
        for (clockwise, (cull, cull_name)) in [false, true]
            .into_iter()
            .flat_map(|order| CULLS.map(|cull| (order, cull)))
        {
            let modes = Modes {
                clockwise,
                ..Modes::new(domain, spacing)
            };
            let order = if clockwise { "cw" } else { "ccw" };
            let name = format!(
                "{}-{}-{order}-cull_{cull_name}",
                domain.name(),
                spacing.name()
            );
            let points = View {
                modes: Modes {
                    points: true,
                    ..modes
                },
                origin: vk::TessellationDomainOrigin::UPPER_LEFT,
                front: vk::FrontFace::COUNTER_CLOCKWISE,
                cull,
            };
            cases.push(case("points", &name, points));
            if domain == Domain::Isolines {
                cases.push(case("lines", &name, View { modes, ..points }));
                continue;
            }
            for ((front, front_name), (origin, origin_name)) in FRONTS
                .into_iter()
                .flat_map(|front| ORIGINS.map(|origin| (front, origin)))
            {
                let view = View {
                    modes,
                    origin,
                    front,
                    cull,
                };
                let name = format!("{name}-front_{front_name}-{origin_name}");
                cases.push(case("triangles", &name, view));
            }
        }
    }
    for ((cull, cull_name), is_clipped) in CULLS[1..3]
        .iter()
        .flat_map(|&cull| [false, true].map(|is_clipped| (cull, is_clipped)))
    {
        let rule = "culling leaves of each triangle what its fragments would be told, whatever else is drawn";
        let beside = if is_clipped { "clipped" } else { "inside" };
        let name = format!("winding.slivers.cull_{cull_name}-beside_{beside}");
        cases.push(Case::new(name, rule, SOURCE, move |context| {
            culled_slivers(context, cull, is_clipped)
        }));
    }
    cases
}

fn case(subgroup: &str, name: &str, view: View) -> Case {
    let rule = if view.has_triangles() {
        "the front is where the vertices' order and the domain's origin say, and culling leaves the other side"
    } else {
        "lines and points are fronts, and nothing culls them"
    };
    let name = format!("winding.{subgroup}.{name}");
    Case::new(name, rule, SOURCE, move |context| seen(context, view))
}
