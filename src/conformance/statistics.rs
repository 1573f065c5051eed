//! Group `statistics`: the driver's own counters equal what the CPU predicts.
//!
//! A seeded fault predicts one patch more.

use crate::abi;
use crate::conformance::capture::{
    SPACINGS, captured, cut, over_patches, prepare, spacing_name, vertices,
};
use crate::conformance::coordinates::{TessLevels, segments, shoot};
use crate::conformance::meshes::{can_draw, under};
use crate::conformance::modes::{Domain, Modes, Spacing, module};
use crate::conformance::raw::{Program, Raster, Raw};
use crate::conformance::{Case, Check, Context, Finding, Group, Status, models};
use crate::error::Result;
use crate::gpu::{Cut, Fill, Shading};
use crate::host::StatisticsQuery;
use crate::mesh::{Model, builtin};
use crate::method::{METHODS, Pass, Prepared};

/// The group.
pub const GROUP: Group = Group {
    name: "statistics",
    about: "the driver's counters, against the predicted work",
    cases,
    model_cases: Some(model_cases),
};

const SOURCE: &str = "Vulkan, Pipeline Statistics Queries";
const RULE: &str = "patches, evaluations, triangles and stencils are as many as predicted";

const SHAPES: [&str; 8] = [
    "cube",
    "hull",
    "ngons",
    "sheet",
    "creased-torus",
    "pole-7",
    "pole-64",
    "cubes-4x3x2",
];

const LEVELS: [f32; 5] = [1.0, 2.0, 5.0, 7.5, 16.0];

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for shape in SHAPES {
        for (method, spacing) in METHODS
            .iter()
            .filter(|method| can_draw(method, shape, method.schemes[0]))
            .flat_map(|method| SPACINGS.map(|spacing| (method, spacing)))
        {
            let name = format!(
                "statistics.{}.{shape}-{}",
                method.name,
                spacing_name(spacing)
            );
            cases.push(Case::new(name, RULE, SOURCE, move |context| {
                let model = Model::new(under(builtin(shape)?, method.schemes[0])?);
                let cuts = LEVELS.map(|level| cut(level, spacing));
                predicted(context, &model, method.name, &cuts, |prepared, _| prepared)
            }));
        }
    }
    let rule = "a query begins where constants are pushed and no pipeline is bound yet, and counts what is drawn behind";
    let source = "Vulkan, Queries; Push Constant Updates";
    cases.push(Case::new(
        "statistics.begun.constants_pushed",
        rule,
        source,
        begun,
    ));
    for (domain, spacing) in [Domain::Triangles, Domain::Quads]
        .into_iter()
        .flat_map(|domain| Spacing::ALL.map(|spacing| (domain, spacing)))
    {
        let modes = Modes::new(domain, spacing);
        let name = format!(
            "statistics.tessellator.{}-{}",
            domain.name(),
            spacing.name()
        );
        let rule = "a patch has the triangles that its levels construct";
        let source = "Vulkan, Triangle Tessellation and Quad Tessellation";
        let run = move |context: &Context| triangles(context, modes);
        cases.push(Case::new(name, rule, source, run));
    }
    cases
}

fn model_cases(name: &str) -> Vec<Case> {
    SPACINGS
        .map(|spacing| {
            let model = name.to_owned();
            let name = format!("statistics.model.{name}-{}", spacing_name(spacing));
            Case::new(name, RULE, SOURCE, move |context| {
                let model = context.model(&model)?;
                let cuts = [1.0, 3.0, 8.0].map(|level| cut(level, spacing));
                match models::by_default(model) {
                    Ok((method, _)) => {
                        predicted(context, model, method.name, &cuts, models::bounded)
                    }
                    Err(skipped) => Ok(skipped),
                }
            })
            .within(models::LIMIT)
        })
        .into()
}

/// One patch a face that the scheme takes whole, or four where the method refines first, and one a corner of other faces; none in holes. Where faces are in
/// pieces, all that there are.
fn patches(model: &Model, prepared: &Prepared) -> u64 {
    let mut all = prepared.passes.iter().flat_map(|pass| &pass.patches);
    if all
        .clone()
        .any(|patch| patch.flags >> abi::PATCH_CHILD_SHIFT & 15 == abi::CHILD_PIECE)
    {
        return all.count() as u64;
    }
    let refined = all.any(|patch| patch.flags & abi::PATCH_REFINED != 0);
    let scheme = model.mesh().options().scheme;
    let faces = model.mesh().faces().enumerate();
    let drawn = faces.filter(|&(face, _)| !model.topology().is_hole(face as u32));
    drawn
        .map(|(_, vertices)| match vertices.len() {
            n if scheme.is_whole(n) => 1 + 3 * u64::from(refined),
            n => n as u64,
        })
        .sum()
}

/// The patches of a pass that a draw has: all, or those from the first that is drawn to the last, where frames go as deep as they need.
fn submitted(pass: &Pass, cut: Cut) -> u32 {
    if !pass.is_dynamic() {
        return pass.patches.len() as u32;
    }
    let is_drawn = |&patch: &usize| cut.levels(pass, patch).is_some();
    let drawn = || (0..pass.patches.len()).filter(is_drawn);
    let ends = drawn().next().zip(drawn().next_back());
    ends.map_or(0, |(first, last)| (last + 1 - first) as u32)
}

/// `bounded` says what is drawn of what was prepared.
fn predicted(
    context: &Context,
    model: &Model,
    method: &str,
    cuts: &[Cut],
    bounded: fn(Prepared, Cut) -> Prepared,
) -> Result<Finding> {
    let mut check = Check::default();
    let (mut work, mut wanted) = ([0; 3], [0; 3]);
    let whole = prepare(model, method)?;
    let (made, right) = (over_patches(&whole, |_, _| 1), patches(model, &whole));
    check.hold(u64::from(made) == right, || {
        format!("{made} patches were made instead of {right}")
    });
    for &cut in cuts {
        let prepared = bounded(whole.clone(), cut);
        let points = over_patches(&prepared, |pass, patch| {
            cut.points(&prepared.passes[pass], patch)
        });
        let triangles = over_patches(&prepared, |pass, patch| {
            let levels = cut.levels(&prepared.passes[pass], patch);
            levels.map_or(0, |levels| levels.triangles(cut.spacing))
        });
        let passes = prepared.passes.iter().map(|pass| submitted(pass, cut));
        let patches = passes.sum::<u32>() + u32::from(context.is_wrong());
        let evaluations = u64::from(vertices(&prepared, cut));
        let right = [u64::from(patches), evaluations, u64::from(triangles)];
        let frame = captured(context, model, prepared, cut, Fill::Solid(Shading::Patch))?;
        let Some(counted) = frame.statistics else {
            return Ok(Finding::skip("the device has no pipelineStatisticsQuery"));
        };
        check_counts(&mut check, cut, counted, right);
        check.hold(frame.counters.points >= points, || {
            format!(
                "{cut:?}: {} stencils, fewer than {points}",
                frame.counters.points
            )
        });
        work = std::array::from_fn(|i| work[i] + counted[i]);
        wanted = std::array::from_fn(|i| wanted[i] + right[i]);
    }
    let [patches, evaluations, triangles] = work;
    let found = check.finish(format!(
        "{patches} patches, {evaluations} evaluations, {triangles} triangles at {} levels",
        cuts.len()
    ));
    let more = work[..2] != wanted[..2];
    if more && found.status == Status::Pass {
        let [patches, evaluations, _] = wanted;
        return Ok(Finding::warn(format!(
            "{}, where {patches} and {evaluations} would do",
            found.measured
        )));
    }
    Ok(found)
}

/// Shaders may run more often than once a patch or vertex (Vulkan, "Tessellation Evaluation Shader Execution"); primitives are exact.
fn check_counts(check: &mut Check, cut: Cut, counted: [u64; 3], right: [u64; 3]) {
    let at_least = counted[0] >= right[0] && counted[1] >= right[1];
    check.hold(at_least && counted[2] == right[2], || {
        format!(
            "{cut:?}: counted {counted:?} patches, evaluations and triangles, predicted {right:?}"
        )
    });
}

/// The triangles of a patch whose levels are all the same: one ring inside the other, each as many as both of its edges have segments.
fn triangle_count(domain: Domain, segments: u32) -> u64 {
    let n = u64::from(segments);
    match domain {
        Domain::Quads => 2 * n * n,
        // n segments a side and n - 2 inside make 3 (2 n - 2); the middle is one triangle for odd n.
        _ => {
            let rings = (0..n / 2).map(|ring| 3 * (2 * (n - 2 * ring) - 2));
            rings.sum::<u64>() + n % 2
        }
    }
}

fn triangles(context: &Context, modes: Modes) -> Result<Finding> {
    let most = context.device()?.limits().max_tessellation_generation_level as f32;
    let mut check = Check::default();
    let mut counted_all = 0;
    for level in [
        1.0, 2.0, 3.0, 4.0, 5.0, 6.5, 8.0, 13.0, 31.0, 32.0, 63.0, 64.0,
    ] {
        let table = [TessLevels::uniform(level)];
        let shot = shoot(context, modes, &table, Raster::Solid)?;
        let Some(counted) = shot.primitives else {
            return Ok(Finding::skip("the device has no pipelineStatisticsQuery"));
        };
        let segments = segments(modes.spacing, level, most);
        let right = triangle_count(modes.domain, segments) + u64::from(context.is_wrong());
        check.hold(counted == right, || {
            format!("level {level}: {counted} triangles instead of {right}")
        });
        counted_all += counted;
    }
    Ok(check.finish(format!("{counted_all} triangles")))
}

/// As where a dispatch, which has constants, stands before draws that are counted.
fn begun(context: &Context) -> Result<Finding> {
    let device = context.device()?;
    if !device.info().support.optional.pipeline_statistics_query {
        return Ok(Finding::skip("the device has no pipelineStatisticsQuery"));
    }
    let modes = Modes::new(Domain::Quads, Spacing::Equal);
    let table = [TessLevels::uniform(3.0)];
    let mut raw = Raw::new(device, &[size_of_val(&table) as u64, 4], 16)?;
    raw.write(0, &table)?;
    let evaluation = modes.rewrite(module("connectivity.tese")?);
    let pipeline = raw.pipeline(&Program::new(module("coordinates.tesc")?, evaluation)?)?;
    let query = StatisticsQuery::new(device)?;
    raw.submit_all(
        Some(&query),
        |cmd| cmd.push(&0u32),
        |cmd| {
            cmd.bind(pipeline, &0u32);
            cmd.draw(1, 1, 0, 0);
        },
    )?;
    let [patches, evaluations, triangles] = query.read()?;
    context.saw(triangles);
    let mut check = Check::default();
    let right = triangle_count(modes.domain, 3) + u64::from(context.is_wrong());
    let holds = patches >= 1 && evaluations >= 16 && triangles == right;
    check.hold(holds, || {
        format!("{patches} patches, {evaluations} evaluations and {triangles} triangles instead of 1, 16 and {right}")
    });
    Ok(check.finish(format!("{triangles} triangles")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_counted_by_rings() {
        let counts = [1, 2, 3, 4, 5].map(|n| triangle_count(Domain::Triangles, n));
        assert_eq!(counts, [1, 6, 13, 24, 37]);
        assert_eq!(triangle_count(Domain::Quads, 3), 18);
    }
}
