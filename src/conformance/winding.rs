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
