//! Group `limit`: captured positions and normals against the truth.
//!
//! Distances are in units: last places of a float that is as large as the model, which is the diagonal times 2^-23. A seeded fault moves a
//! control vertex by a part in a thousand before the truth is asked.

mod hexagon;
mod lattice;
mod ruler;

use crate::abi;
use crate::conformance::capture::{SPACINGS, captured, cut, spacing_name};
use crate::conformance::meshes::{
    Draft, can_draw, cornered_sheet, creased_sheet, framed_polygon, moved, open_star, star, under,
};
use crate::conformance::{Case, Check, Context, Finding, Group, LIMIT, models};
use crate::error::Result;
use crate::gpu::{Cut, Fill};
use crate::mesh::{ControlMesh, CreaseMethod, Model, SchemeOptions, builtin};
use crate::method::{METHODS, Method, MethodOptions, Prepared, method, method_for};
use crate::plan::PlanOptions;
use crate::tessellation::Spacing;
use ruler::{Kind, Ruler, samples};

/// The group.
pub const GROUP: Group = Group {
    name: "limit",
    about: "positions and normals, against the limit in f64",
    cases,
    model_cases: Some(model_cases),
};

const PAPER: &str = "Brainerd et al. 2016, sections 4 to 7";
const RULE: &str = "positions and normals keep the method's contract";

/// The points of a frame that are compared at most: the truth takes its time.
const SAMPLES: usize = 1500;

/// How a surface is prepared and drawn.
#[derive(Clone, Copy)]
struct Setup {
    /// By default whichever draws the scheme.
    method: Option<&'static str>,
    options: MethodOptions,
    cut: Cut,
    /// Only what is evaluated so.
    kind: Option<Kind>,
}

impl Setup {
    fn new(level: f32, spacing: Spacing) -> Setup {
        Setup {
            method: None,
            options: MethodOptions::default(),
            cut: cut(level, spacing),
            kind: None,
        }
    }
}

/// A case for a mesh that is made when it runs.
fn case(
    name: String,
    setup: Setup,
    mesh: impl Fn(&Context) -> Result<ControlMesh> + Send + Sync + 'static,
) -> Case {
    Case::new(name, RULE, PAPER, move |context| {
        measure(context, &Model::new(mesh(context)?), setup)
    })
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend(valences());
    cases.extend(sharpnesses());
    cases.extend(kinds());
    cases.extend(depths());
    cases.extend(levels());
    cases.extend(shapes());
    cases.extend(lattice::cases());
    cases.extend(lattice::tables());
    cases.extend(hexagon::cases());
    cases.extend(places());
    cases.extend((0..30).map(|number| {
        let setup = Setup::new(9.0, SPACINGS[number % 2]);
        case(format!("limit.random.{number}"), setup, move |context| {
            Draft::random(context.random(&format!("limit.random.{number}")))
        })
    }));
    cases
}

fn model_cases(name: &str) -> Vec<Case> {
    SPACINGS
        .map(|spacing| {
            let model = name.to_owned();
            let name = format!("limit.model.{name}-{}", spacing_name(spacing));
            let setup = Setup::new(8.0, spacing);
            Case::new(name, RULE, PAPER, move |context| {
                let model = context.model(&model)?;
                match models::by_default(model) {
                    Ok((method, prepared)) => {
                        let prepared = models::bounded(prepared, setup.cut);
                        measure_prepared(context, model, setup, method, prepared)
                    }
                    Err(skipped) => Ok(skipped),
                }
            })
            .within(models::LIMIT)
        })
        .into()
}

/// Interior vertices of quads, of triangles, and boundary vertices.
fn valences() -> impl Iterator<Item = Case> {
    let setup = Setup::new(8.0, Spacing::Equal);
    let quads = (3..=16).chain([20, 24, 31, 32, 33, 48, 63, 64]);
    let quads = quads.map(move |n| {
        case(format!("limit.valence.quads-{n}"), setup, move |_| {
            star(n).build()
        })
    });
    let triangles = [3, 4, 5, 6, 7, 12, 31, 32, 64].map(move |n| {
        case(format!("limit.valence.triangles-{n}"), setup, move |_| {
            builtin(&format!("pole-{n}"))
        })
    });
    let boundary = [1, 2, 3, 4, 5, 6, 8, 16, 32].map(move |n| {
        case(format!("limit.valence.boundary-{n}"), setup, move |_| {
            open_star(n).build()
        })
    });
    let polygons = [3, 5, 6, 7, 8, 12, 20].map(move |n| {
        case(format!("limit.valence.polygon-{n}"), setup, move |_| {
            framed_polygon(n).build()
        })
    });
    quads.chain(triangles).chain(boundary).chain(polygons)
}

fn sharpnesses() -> impl Iterator<Item = Case> {
    let setup = Setup::new(11.0, Spacing::Equal);
    let word = |sharpness: f32| format!("{sharpness:.1}").replace('.', "_");
    let all = [0.1, 0.5, 1.0, 1.3, 2.0, 2.7, 3.0, 4.2, 6.0, 8.5, 9.9, 10.0];
    let creases = all.map(|sharpness| {
        let name = format!("limit.sharpness.crease-{}", word(sharpness));
        case(name, setup, move |_| {
            creased_sheet(sharpness, 6, SchemeOptions::default())
        })
    });
    let darts = [0.5, 1.5, 3.0, 10.0].map(|sharpness| {
        let name = format!("limit.sharpness.dart-{}", word(sharpness));
        case(name, setup, move |_| {
            creased_sheet(sharpness, 3, SchemeOptions::default())
        })
    });
    let corners = [0.5, 1.0, 2.4, 5.0, 10.0].map(|sharpness| {
        let name = format!("limit.sharpness.corner-{}", word(sharpness));
        case(name, setup, move |_| cornered_sheet(sharpness))
    });
    let chaikin = [0.7, 1.5, 3.2].map(|sharpness| {
        let name = format!("limit.sharpness.chaikin-{}", word(sharpness));
        let options = SchemeOptions {
            creasing: CreaseMethod::Chaikin,
            ..Default::default()
        };
        case(name, setup, move |_| creased_sheet(sharpness, 4, options))
    });
    let all = creases.into_iter().chain(darts);
    all.chain(corners).chain(chaikin)
}

/// The kinds, each in a shape that has many of it.
const KINDS: [(&str, Kind, &str); 6] = [
    ("regular", Kind::Node(abi::NODE_REGULAR), "hull"),
    ("boundary", Kind::Node(abi::NODE_BOUNDARY), "sheet"),
    ("crease", Kind::Node(abi::NODE_CREASE), "creased-torus"),
    ("terminal", Kind::Node(abi::NODE_TERMINAL), "ngons"),
    ("edge", Kind::Edge, "hull"),
    ("corner", Kind::Corner, "hull"),
];

fn kinds() -> impl Iterator<Item = Case> {
    KINDS.into_iter().flat_map(|(name, kind, shape)| {
        SPACINGS.map(|spacing| {
            let setup = Setup {
                kind: Some(kind),
                ..Setup::new(12.0, spacing)
            };
            let name = format!("limit.kind.{name}-{}", spacing_name(spacing));
            case(name, setup, move |_| builtin(shape))
        })
    })
}

fn depths() -> impl Iterator<Item = Case> {
    let depths = (1..=8).map(|max_level| {
        let options = PlanOptions {
            max_level,
            ..Default::default()
        };
        let level = (1u32 << max_level).min(20) as f32;
        let setup = Setup {
            options: options.into(),
            ..Setup::new(level, Spacing::Equal)
        };
        case(format!("limit.depth.{max_level}_levels"), setup, |_| {
            builtin("ngons")
        })
    });
    let refined = Setup {
        options: MethodOptions::from(PlanOptions {
            direct_creases: false,
            ..Default::default()
        }),
        ..Setup::new(9.0, Spacing::Equal)
    };
    let name = "limit.depth.refined_creases".to_owned();
    depths.chain([case(name, refined, |_| builtin("creased-torus"))])
}

fn levels() -> impl Iterator<Item = Case> {
    let whole = [1, 2, 3, 4, 5, 7, 8, 13, 16, 31, 33, 63, 64];
    let whole = whole
        .into_iter()
        .flat_map(|level| SPACINGS.map(|spacing| (level.to_string(), level as f32, spacing)));
    let between = [1.5, 2.3, 4.7, 10.1, 63.3];
    let between = between.map(|level| {
        let word = level.to_string().replace('.', "_");
        (word, level, Spacing::FractionalEven)
    });
    whole.chain(between).map(|(word, level, spacing)| {
        let name = format!("limit.level.{word}-{}", spacing_name(spacing));
        case(name, Setup::new(level, spacing), |_| builtin("cube"))
    })
}

const SHAPES: [&str; 6] = [
    "hull",
    "ngons",
    "sheet",
    "creased-torus",
    "cubes-2x1x1",
    "pole-360",
];

/// Every method under every scheme that it does, as far as scheme and method know the shape's tags.
fn shapes() -> impl Iterator<Item = Case> {
    let pairs = METHODS
        .iter()
        .flat_map(|method| method.schemes.iter().map(move |&scheme| (method, scheme)));
    let triples = pairs.flat_map(|(method, scheme)| SHAPES.map(|shape| (method, scheme, shape)));
    let known = triples.filter(|&(method, scheme, shape)| can_draw(method, shape, scheme));
    known.flat_map(|(method, scheme, shape)| {
        let method = method.name;
        SPACINGS.map(|spacing| {
            let setup = Setup {
                method: Some(method),
                ..Setup::new(6.0, spacing)
            };
            let name = format!("limit.{method}.{shape}-{scheme}-{}", spacing_name(spacing));
            let case = case(name, setup, move |_| under(builtin(shape)?, scheme));
            // The butterfly is refined twenty times around a vertex of this valence.
            match shape {
                "pole-360" => case.within(4 * LIMIT),
                _ => case,
            }
        })
    })
}

/// Scales and distances from the origin.
const PLACES: [(&str, f64, f64); 5] = [
    ("far", 0.1, 1000.0),
    ("farther", 1.0, 1e7),
    ("tiny", 1e-9, 0.0),
    ("large", 1e9, 0.0),
    ("enormous", 1e25, 0.0),
];

fn places() -> impl Iterator<Item = Case> {
    PLACES.into_iter().flat_map(|(word, scale, by)| {
        ["hull", "ngons"].map(|shape| {
            let setup = Setup::new(8.0, Spacing::Equal);
            case(format!("limit.place.{word}-{shape}"), setup, move |_| {
                moved(&builtin(shape)?, scale, by)
            })
        })
    })
}

fn measure(context: &Context, model: &Model, setup: Setup) -> Result<Finding> {
    let method = match setup.method {
        Some(name) => method(name)?,
        None => method_for(model),
    };
    let prepared = method.prepare(model, setup.options)?;
    measure_prepared(context, model, setup, method, prepared)
}

fn measure_prepared(
    context: &Context,
    model: &Model,
    setup: Setup,
    method: &Method,
    prepared: Prepared,
) -> Result<Finding> {
    let passes = prepared.clone();
    let frame = captured(context, model, prepared, setup.cut, Fill::Discard)?;
    let ruler = Ruler::new(context, model, method, &passes, setup.options)?;
    let samples = samples(&passes, &frame, setup.kind);
    let step = (samples.len() / most_samples(&passes)) | 1;
    let mut check = Check::default();
    check.hold(frame.counters.overflows == 0, || {
        format!("{} patches were left out", frame.counters.overflows)
    });
    let mut worst = [0.0; 2];
    let mut count = 0;
    for (pass, vertex) in samples.into_iter().step_by(step) {
        let off = ruler.hold(&mut check, pass, vertex);
        worst = std::array::from_fn(|i| f64::max(worst[i], off[i]));
        count += 1;
    }
    if count == 0 {
        return Ok(Finding::fail("no vertex lies in such a node"));
    }
    Ok(check.finish(format!(
        "{count} points, at most {:.2} units and {:.5} degrees off",
        worst[0], worst[1]
    )))
}

/// How many points are compared: fewer where each of the truth's is a sum over thousands of vertices.
fn most_samples(prepared: &Prepared) -> usize {
    let passes = prepared.passes.iter();
    let lists = passes.map(|pass| pass.controls.len() / pass.patches.len().max(1));
    SAMPLES * 200 / lists.max().unwrap_or(0).max(200)
}
