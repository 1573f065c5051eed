//! Group `determinism`: the same bits, whatever runs when.
//!
//! Each case captures a surface twice under conditions that should not matter. A seeded fault moves a control vertex of the second.

use crate::conformance::capture::{
    Frame, SPACINGS, bits, captured, capturing, cut, over_patches, prepare, spacing_name, vertices,
};
use crate::conformance::{Case, Check, Context, Finding, Group};
use crate::error::Result;
use crate::gpu::{Cut, Fill, Remedy, Slots, SurfaceOptions, Workaround, workaround};
use crate::mesh::{ControlMesh, Model, builtin};
use crate::method::Prepared;

/// The group.
pub const GROUP: Group = Group {
    name: "determinism",
    about: "the same bits, whatever runs when",
    cases,
    model_cases: None,
};

/// A patch an instance, as no known driver needs it.
pub(super) static ONE_A_TIME: Workaround = Workaround {
    remedy: Remedy::SplitBatches { max_vertices: 1 },
    name: "one-a-time",
    ..workaround::WORKAROUNDS[0]
};

const SHAPES: [&str; 4] = ["hull", "ngons", "creased-torus", "pole-64"];

/// What should not matter.
struct Condition {
    name: &'static str,
    rule: &'static str,
    second: fn(&Context, &Model, Cut, &mut Check, &Frame) -> Result<()>,
}

const CONDITIONS: [Condition; 7] = [
    Condition {
        name: "repeated",
        rule: "drawn again and again, the bits stay the same",
        second: repeated,
    },
    Condition {
        name: "batches",
        rule: "the bits do not depend on how many patches are drawn at once",
        second: batches,
    },
    Condition {
        name: "ring",
        rule: "the bits do not depend on the size of the scratch ring",
        second: ring,
    },
    Condition {
        name: "slots",
        rule: "the bits do not depend on who gives slots",
        second: slots,
    },
    Condition {
        name: "instances",
        rule: "the bits do not depend on how many instances a draw is made of",
        second: instances,
    },
    Condition {
        name: "cache",
        rule: "pipelines from a cold and from a warm cache give the same bits",
        second: cache,
    },
    Condition {
        name: "threads",
        rule: "plans built by one thread and by many give the same bits",
        second: threads,
    },
];

const SOURCE: &str = "Vulkan, Invariance, Repeatability; Tessellation Invariance, rule 1";

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for condition in &CONDITIONS {
        for (shape, spacing) in SHAPES
            .into_iter()
            .flat_map(|shape| SPACINGS.map(|spacing| (shape, spacing)))
        {
            let name = format!(
                "determinism.{}.{shape}-{}",
                condition.name,
                spacing_name(spacing)
            );
            let cut = cut(7.0, spacing);
            let run = move |context: &Context| check(context, condition, shape, cut);
            cases.push(Case::new(name, condition.rule, SOURCE, run));
        }
    }
    cases
}

fn check(context: &Context, condition: &Condition, shape: &str, cut: Cut) -> Result<Finding> {
    let model = Model::new(builtin(shape)?);
    let prepared = prepare(&model, "quadtree")?;
    let predicted = vertices(&prepared, cut) as usize;
    let first = captured(context, &model, prepared, cut, Fill::Discard)?;
    let arrived: usize = first.passes.iter().map(Vec::len).sum();
    let mut check = Check::default();
    check.hold(arrived == predicted, || {
        format!("{arrived} vertices instead of {predicted}")
    });
    check.hold(first.differing == 0, || {
        format!("{} vertices came twice, with other bits", first.differing)
    });
    let again = if context.is_wrong() {
        Model::new(nudged(model.mesh())?)
    } else {
        model
    };
    (condition.second)(context, &again, cut, &mut check, &first)?;
    Ok(check.finish(format!("{arrived} vertices")))
}

/// A mesh with one vertex moved by a part in 10,000.
fn nudged(mesh: &ControlMesh) -> Result<ControlMesh> {
    let mut positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.to_array()).collect();
    let (low, high) = mesh.bounds();
    positions[0][0] += 1e-4 * low.distance(high);
    super::meshes::with_positions(mesh, &positions)
}

fn compare(check: &mut Check, what: &str, frame: &Frame, right: &Frame) {
    check.hold(frame.counters.overflows == 0, || {
        format!("{what}: {} patches were left out", frame.counters.overflows)
    });
    let (found, wanted) = (frame.bits(), right.bits());
    check.hold(found.len() == wanted.len(), || {
        format!("{what}: {} vertices, not {}", found.len(), wanted.len())
    });
    let vertices = frame.passes.iter().flatten();
    for (vertex, right) in vertices.zip(right.passes.iter().flatten()) {
        check.hold(bits(vertex) == bits(right), || {
            format!("{what}: {vertex:?} instead of {right:?}")
        });
    }
}

/// Captures with other options.
fn capture_with(
    context: &Context,
    model: &Model,
    cut: Cut,
    workarounds: &[&'static Workaround],
    change: impl FnOnce(&Prepared, &mut SurfaceOptions),
) -> Result<Frame> {
    let prepared = prepare(model, "quadtree")?;
    let mut options = capturing(context, &prepared, cut);
    change(&prepared, &mut options);
    let bench = context.bench()?;
    let mut loaded = bench.load(model, prepared, workarounds, options)?;
    loaded.capture(cut, Fill::Discard)
}

fn repeated(
    context: &Context,
    model: &Model,
    cut: Cut,
    check: &mut Check,
    first: &Frame,
) -> Result<()> {
    let prepared = prepare(model, "quadtree")?;
    let options = capturing(context, &prepared, cut);
    let workarounds = context.workarounds()?;
    let bench = context.bench()?;
    let mut loaded = bench.load(model, prepared, &workarounds, options)?;
    for run in 0..5 {
        let frame = loaded.capture(cut, Fill::Discard)?;
        compare(check, &format!("run {run}"), &frame, first);
    }
    Ok(())
}

fn batches(
    context: &Context,
    model: &Model,
    cut: Cut,
    check: &mut Check,
    first: &Frame,
) -> Result<()> {
    let workarounds = context.workarounds()?;
    for vertices in [100, 1000, 5000] {
        let frame = capture_with(context, model, cut, &workarounds, |_, options| {
            options.capture_vertices = options.capture_vertices.min(2 * vertices);
        });
        compare(check, &format!("{vertices} vertices"), &frame?, first);
    }
    Ok(())
}

fn ring(
    context: &Context,
    model: &Model,
    cut: Cut,
    check: &mut Check,
    first: &Frame,
) -> Result<()> {
    let workarounds = context.workarounds()?;
    for (what, times) in [("smallest", 1), ("small", 3), ("whole", 0)] {
        let frame = capture_with(context, model, cut, &workarounds, |prepared, options| {
            options.ring_bytes = match times {
                0 => 2 * whole_ring(prepared, cut),
                times => times * smallest_ring(prepared, cut),
            };
        });
        compare(check, &format!("{what} ring"), &frame?, first);
    }
    Ok(())
}

/// A ring for exactly the hungriest patch.
pub(super) fn smallest_ring(prepared: &Prepared, cut: Cut) -> u64 {
    let passes = prepared.passes.iter();
    let points = passes
        .flat_map(|pass| (0..pass.patches.len()).map(move |patch| cut.points(pass, patch)))
        .max();
    16 * u64::from(points.unwrap_or(0).max(1))
}

/// A ring for everything at once.
pub(super) fn whole_ring(prepared: &Prepared, cut: Cut) -> u64 {
    let points = over_patches(prepared, |pass, patch| {
        cut.points(&prepared.passes[pass], patch)
    });
    16 * u64::from(points.max(1))
}

fn slots(
    context: &Context,
    model: &Model,
    cut: Cut,
    check: &mut Check,
    first: &Frame,
) -> Result<()> {
    let workarounds = context.workarounds()?;
    for slots in [Slots::Counter, Slots::Host] {
        let frame = capture_with(context, model, cut, &workarounds, |_, options| {
            options.slots = slots;
        });
        compare(check, &format!("{slots:?}"), &frame?, first);
    }
    Ok(())
}

fn instances(
    context: &Context,
    model: &Model,
    cut: Cut,
    check: &mut Check,
    first: &Frame,
) -> Result<()> {
    let frame = capture_with(context, model, cut, &[&ONE_A_TIME], |_, _| ())?;
    compare(check, "a patch an instance", &frame, first);
    Ok(())
}

fn cache(
    context: &Context,
    model: &Model,
    cut: Cut,
    check: &mut Check,
    first: &Frame,
) -> Result<()> {
    let workarounds = context.workarounds()?;
    let (bench, prepared) = (context.bench()?, prepare(model, "quadtree")?);
    let mut held = Vec::new();
    for what in ["cold", "warm"] {
        held = bench.rebuild(&prepared, cut.spacing, Fill::Discard, &held)?;
        let frame = capture_with(context, model, cut, &workarounds, |_, _| ())?;
        compare(check, &format!("{what} cache"), &frame, first);
    }
    Ok(())
}

fn threads(
    context: &Context,
    model: &Model,
    cut: Cut,
    check: &mut Check,
    first: &Frame,
) -> Result<()> {
    for threads in [1, 3, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| crate::Error::Refused(error.to_string()))?;
        let prepared = pool.install(|| prepare(model, "quadtree"))?;
        let frame = captured(context, model, prepared, cut, Fill::Discard)?;
        compare(check, &format!("{threads} threads"), &frame, first);
    }
    Ok(())
}
