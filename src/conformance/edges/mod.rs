//! Group `edges`: the same bits on every shared edge.
//!
//! Two faces that compute the points of their common edge each in its own way get almost the same points, and almost is a crack. The rule is
//! exact: on every edge of the mesh, and on every spoke inside of an n-gon, all faces there have the same vertices, and at each the same
//! bits of position and normal; at a vertex of the mesh all faces around it. So nothing here has a tolerance.
//!
//! Numbers are compared by [`compare`], pictures by `pictures`. A seeded fault flips one bit of one captured position, or moves the control
//! vertices of every other patch by less than a pixel can show.

mod cases;
mod pictures;
mod shared;

use crate::conformance::capture::{Loaded, SPACINGS, capturing, cut};
use crate::conformance::determinism::{ONE_A_TIME, smallest_ring, whole_ring};
use crate::conformance::meshes::Draft;
use crate::conformance::{Context, Finding, Group, models};
use crate::error::Result;
use crate::gpu::{Cut, Fill, Slots, SurfaceOptions};
use crate::mesh::{ControlMesh, Model};
use crate::method::{Displacement, METHODS, Method, MethodOptions, Prepared};
use crate::tessellation::Spacing;

pub use shared::{Compared, LineKind, Shared};

/// The group.
pub const GROUP: Group = Group {
    name: "edges",
    about: "the same bits on every shared edge and at every shared vertex",
    cases: cases::cases,
    model_cases: Some(cases::model_cases),
};

/// The levels that are looked at: both ends, powers of two and numbers that fit no half, and one between whole numbers.
pub const LEVELS: [f32; 12] = [
    1.0, 2.0, 3.0, 5.0, 7.0, 8.0, 11.9, 13.0, 16.0, 31.0, 63.0, 64.0,
];

/// How a surface gets its place in the scratch ring, and how much is drawn at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drawn {
    /// As the suite is told.
    #[default]
    Usual,
    /// Through a ring for no more than the hungriest patch.
    SmallestRing,
    /// Through a ring for so many such patches.
    SmallRing(u32),
    /// Through a ring for everything at once.
    WholeRing,
    /// With slots from the host, or from counters.
    Slots(Slots),
    /// A patch an instance.
    OneAtATime,
    /// So many vertices at once.
    Batches(u32),
}

/// How a model is prepared, drawn and compared.
#[derive(Clone, Debug)]
pub struct Setup {
    /// What methods prepare with.
    pub options: MethodOptions,
    /// The tess levels.
    pub levels: Vec<f32>,
    /// The spacings.
    pub spacings: Vec<Spacing>,
    /// The height of a displacement, as a share of the diagonal; 0 for none.
    pub displacement: f64,
    /// How it is drawn.
    pub drawn: Drawn,
    /// Compare lines of this kind only, and the vertices at their ends.
    pub only: Option<LineKind>,
}

impl Setup {
    /// These levels, both spacings, and nothing special.
    pub fn new(levels: &[f32]) -> Setup {
        Setup {
            options: MethodOptions::default(),
            levels: levels.to_vec(),
            spacings: SPACINGS.to_vec(),
            displacement: 0.0,
            drawn: Drawn::Usual,
            only: None,
        }
    }

    fn cuts(&self) -> Vec<Cut> {
        let levels = self.levels.iter();
        let spacings = || self.spacings.iter();
        levels
            .flat_map(|&level| spacings().map(move |&spacing| cut(level, spacing)))
            .collect()
    }
}

/// Draws a model by every method that promises to be watertight, and compares all that its faces share.
///
/// # Errors
/// Vulkan's.
pub fn compare(context: &Context, model: &Model, setup: &Setup) -> Result<Compared> {
    let mut compared = Compared::default();
    for method in watertight(model) {
        let prepared = method.prepare(model, setup.options)?;
        compared.add(compare_prepared(context, model, setup, prepared)?);
    }
    Ok(compared)
}

/// The methods that draw a model and promise to be watertight.
fn watertight(model: &Model) -> impl Iterator<Item = &'static Method> {
    let whole = METHODS.iter().filter(|method| method.contract.watertight);
    whole.filter(|method| method.check_model(model).is_ok())
}

/// The same for a mesh of the user's, with what there is to say where nothing can be compared. Methods that refuse it do not count.
fn compare_users(context: &Context, model: &Model, setup: &Setup) -> Result<Finding> {
    if !models::shares_something(model) {
        return Ok(Finding::skip("its faces share neither edge nor vertex"));
    }
    let (mut compared, mut skipped, mut drawn) = (Compared::default(), None, false);
    for method in watertight(model) {
        match models::prepared(model, method, setup.options) {
            Ok(prepared) => {
                drawn = true;
                let most = setup
                    .cuts()
                    .into_iter()
                    .max_by(|a, b| a.level.total_cmp(&b.level));
                let prepared = match most {
                    Some(cut) => models::bounded(prepared, cut),
                    None => prepared,
                };
                compared.add(compare_prepared(context, model, setup, prepared)?);
            }
            Err(finding) => skipped = skipped.or(Some(finding)),
        }
    }
    let scheme = model.mesh().options().scheme;
    let none = || format!("no method that promises to be watertight draws this mesh of {scheme}");
    Ok(match (drawn, skipped) {
        (true, _) => finding(&compared),
        (false, Some(skipped)) => skipped,
        (false, None) => Finding::skip(none()),
    })
}

fn compare_prepared(
    context: &Context,
    model: &Model,
    setup: &Setup,
    prepared: Prepared,
) -> Result<Compared> {
    let cuts = setup.cuts();
    let options = options(context, &prepared, &cuts, setup.drawn);
    let workarounds = match setup.drawn {
        Drawn::OneAtATime => vec![&ONE_A_TIME],
        _ => context.workarounds()?,
    };
    let bench = context.bench()?;
    let mut loaded = bench.load(model, prepared, &workarounds, options)?;
    loaded.view.displacement = bumps(model, setup.displacement);
    let mut compared = Compared::default();
    for cut in cuts {
        compared.add(compare_cut(context, model, &mut loaded, cut, setup.only)?);
    }
    Ok(compared)
}

fn compare_cut(
    context: &Context,
    model: &Model,
    loaded: &mut Loaded<'_>,
    cut: Cut,
    only: Option<LineKind>,
) -> Result<Compared> {
    let frame = loaded.capture(cut, Fill::Discard)?;
    let mut shared = Shared::new(model);
    for (pass, vertices) in loaded.prepared().passes.iter().zip(&frame.passes) {
        for vertex in vertices {
            shared.add(pass, vertex);
        }
    }
    if context.is_wrong() {
        shared.spoil(only);
    }
    let mut compared = shared.compare(only);
    let lost = frame.counters.overflows;
    if lost > 0 {
        let words = || format!("{lost} patches were left out");
        compared.first.get_or_insert_with(words);
    }
    compared.first = compared
        .first
        .map(|first| format!("level {} {:?}, {first}", cut.level, cut.spacing));
    Ok(compared)
}

/// A random mesh of the context's seed: with even numbers a manifold one.
///
/// # Errors
/// None.
pub fn random_mesh(context: &Context, number: u32) -> Result<ControlMesh> {
    let random = context.random(&format!("edges.random.{number}"));
    match number % 2 {
        0 => Draft::manifold(random),
        _ => Draft::random(random),
    }
}

/// Options for all cuts.
fn options(context: &Context, prepared: &Prepared, cuts: &[Cut], drawn: Drawn) -> SurfaceOptions {
    let each = cuts.iter().map(|&cut| capturing(context, prepared, cut));
    let most = each.max_by_key(|options| options.capture_vertices);
    let mut options = most.unwrap_or_default();
    let levels = cuts.iter().map(|cut| cut.level);
    options.greatest_level = levels.fold(1.0, f32::max);
    let rings = |ring: fn(&Prepared, Cut) -> u64| cuts.iter().map(move |&cut| ring(prepared, cut));
    let hungriest = rings(smallest_ring).max().unwrap_or(16);
    match drawn {
        Drawn::Usual | Drawn::OneAtATime => {}
        Drawn::SmallestRing => options.ring_bytes = hungriest,
        Drawn::SmallRing(times) => options.ring_bytes = u64::from(times) * hungriest,
        Drawn::WholeRing => options.ring_bytes = 2 * rings(whole_ring).max().unwrap_or(16),
        Drawn::Slots(slots) => options.slots = slots,
        // What is captured in one submission is half of the room.
        Drawn::Batches(vertices) => options.capture_vertices = 2 * vertices,
    }
    options.ring_bytes = options.ring_bytes.max(hungriest);
    options
}

/// Bumps of a height, a share of the diagonal, and twenty along the diagonal.
fn bumps(model: &Model, share: f64) -> Displacement {
    let diagonal = model.diagonal().max(f64::from(f32::MIN_POSITIVE));
    Displacement {
        height: (share * diagonal) as f32,
        frequency: (20.0 / diagonal) as f32,
    }
}

/// The finding of a comparison: a failure if something differs, or if nothing was compared.
fn finding(compared: &Compared) -> Finding {
    match &compared.first {
        Some(first) => Finding::fail(format!("{first}; {compared}")),
        None if compared.positions == 0 => Finding::fail(format!("nothing was shared; {compared}")),
        None => Finding::pass(compared.to_string()),
    }
}
