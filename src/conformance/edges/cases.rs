//! The cases of group `edges`: by what a line lies between, by valence, level, shape, way of drawing, plans, place, and on random meshes.

use crate::conformance::capture::{SPACINGS, spacing_name};
use crate::conformance::edges::{
    Drawn, LEVELS, LineKind, Setup, compare, compare_users, finding, pictures, random_mesh,
};
use crate::conformance::meshes::{
    can_draw, creased_polygons, creased_sheet, framed_polygon, moved, open_star, sheet, star, under,
};
use crate::conformance::{Case, Context, models};
use crate::error::Result;
use crate::gpu::Slots;
use crate::mesh::{ControlMesh, CreaseMethod, Model, Scheme, SchemeOptions, builtin};
use crate::method::{METHODS, MethodOptions, TableNormals, TableOptions};
use crate::plan::PlanOptions;

const RULE: &str = "on every edge and spoke all faces have the same vertices, and there and at every vertex the same bits of position and normal";
const SOURCE: &str = "manual, Edges and corners; Vulkan, Tessellation Invariance, rules 5 and 6; SPIR-V, NoContraction";

/// A case for a mesh that is made when it runs.
fn case(
    name: String,
    setup: Setup,
    mesh: impl Fn(&Context) -> Result<ControlMesh> + Send + Sync + 'static,
) -> Case {
    Case::new(name, RULE, SOURCE, move |context| {
        let model = Model::new(mesh(context)?);
        Ok(finding(&compare(context, &model, &setup)?))
    })
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend(kinds());
    cases.extend(valences());
    cases.extend(levels());
    cases.extend(shapes());
    cases.extend(triangles());
    cases.extend(mixed());
    cases.extend(ways_of_drawing());
    cases.extend(plans());
    cases.extend(tables());
    cases.extend(displaced());
    cases.extend(places());
    cases.extend(random());
    cases.extend(pictures::cases());
    cases
}

pub(super) fn model_cases(name: &str) -> Vec<Case> {
    SPACINGS
        .map(|spacing| {
            let model = name.to_owned();
            let name = format!("edges.model.{name}-{}", spacing_name(spacing));
            let setup = Setup {
                spacings: vec![spacing],
                ..Setup::new(&[1.0, 3.0, 8.0])
            };
            Case::new(name, RULE, SOURCE, move |context| {
                compare_users(context, context.model(&model)?, &setup)
            })
            .within(models::LIMIT)
        })
        .into()
}

/// Shapes of triangles, or of triangles and quads, and random meshes, for the methods that take those. Semi-sharp creases are not for the butterfly.
fn triangles() -> impl Iterator<Item = Case> {
    let shapes = [
        "cube",
        "hull",
        "ngons",
        "sheet",
        "creased-torus",
        "pole-7",
        "pole-64",
    ];
    let shapes = shapes.into_iter().flat_map(|shape| {
        [Scheme::Loop, Scheme::Butterfly, Scheme::LoopStam].map(|scheme| (shape, scheme))
    });
    let known = shapes.filter(|&(shape, scheme)| {
        let mut whole = METHODS.iter().filter(|method| method.contract.watertight);
        whole.any(|method| can_draw(method, shape, scheme))
    });
    let shapes = known.map(|(shape, scheme)| {
        let setup = Setup::new(&[1.0, 2.0, 3.0, 5.0, 8.0]);
        let name = format!("edges.triangles.{shape}-{scheme}");
        case(name, setup, move |_| under(builtin(shape)?, scheme))
    });
    let random = (0..6).map(|number| {
        let setup = Setup::new(&[1.0, 4.0, 7.0]);
        case(
            format!("edges.triangles.random-{number}"),
            setup,
            move |context| under(random_mesh(context, number)?, Scheme::Loop),
        )
    });
    shapes.chain(random)
}

/// Whole triangles beside whole quads.
fn mixed() -> impl Iterator<Item = Case> {
    let poles = [3, 5, 7, 16].map(|n| (format!("pole-{n}"), Source::Pole(n)));
    let frame = [("framed_triangle".to_owned(), Source::Triangle)];
    poles.into_iter().chain(frame).map(|(name, source)| {
        let setup = Setup::new(&[1.0, 2.0, 3.0, 5.0, 8.0, 11.9, 13.0]);
        let name = format!("edges.mixed.{name}");
        case(name, setup, move |_| {
            let mesh = match source {
                Source::Pole(n) => builtin(&format!("pole-{n}"))?,
                Source::Triangle => framed_polygon(3).build()?,
            };
            under(mesh, Scheme::LoopStam)
        })
    })
}

/// Where a mesh of triangles and quads comes from.
#[derive(Clone, Copy)]
enum Source {
    Pole(u32),
    Triangle,
}

type Make = fn() -> Result<ControlMesh>;

/// Meshes that have lines of a kind, most of them more than one kind of such.
const KINDS: [(&str, LineKind, Make); 19] = [
    ("regular", LineKind::Whole, || sheet(6).build()),
    ("regular_irregular", LineKind::RegularAndIrregular, || {
        builtin("creased-torus")
    }),
    ("irregular", LineKind::Whole, || star(5).build()),
    ("quad_polygon", LineKind::QuadAndPolygon, || {
        framed_polygon(5).build()
    }),
    ("quad_triangle", LineKind::QuadAndPolygon, || {
        framed_polygon(3).build()
    }),
    ("polygons", LineKind::Polygons, || builtin("ngons")),
    ("spoke", LineKind::Spoke, || framed_polygon(7).build()),
    ("semi_sharp", LineKind::SemiSharpCrease, || creased(1.0, 6)),
    ("semi_sharp_fraction", LineKind::SemiSharpCrease, || {
        creased(2.7, 6)
    }),
    ("semi_sharp_highest", LineKind::SemiSharpCrease, || {
        creased(9.9, 6)
    }),
    ("semi_sharp_dart", LineKind::SemiSharpCrease, || {
        creased(3.5, 3)
    }),
    ("semi_sharp_chaikin", LineKind::SemiSharpCrease, || {
        let creasing = CreaseMethod::Chaikin;
        let options = SchemeOptions {
            creasing,
            ..Default::default()
        };
        creased_sheet(2.3, 4, options)
    }),
    ("infinite", LineKind::InfiniteCrease, || creased(10.0, 6)),
    ("infinite_dart", LineKind::InfiniteCrease, || {
        creased(10.0, 3)
    }),
    ("boundary", LineKind::Boundary, || open_star(4).build()),
    ("hole", LineKind::Boundary, || {
        sheet(5).tagged(|builder| builder.hole(7).hole(12).hole(13))
    }),
    ("three_faces", LineKind::NonManifold, three_faces),
    ("turned_over", LineKind::NonManifold, || {
        let mut parts = sheet(4);
        parts.faces[5].reverse();
        parts.build()
    }),
    ("valence_two", LineKind::Whole, valence_two),
];

fn creased(sharpness: f32, edges: u32) -> Result<ControlMesh> {
    creased_sheet(sharpness, edges, SchemeOptions::default())
}

/// A sheet with a further face on an edge.
fn three_faces() -> Result<ControlMesh> {
    let mut parts = sheet(4);
    let [a, b] = [parts.faces[5][0], parts.faces[5][1]];
    let next = parts.positions.len() as u32;
    for vertex in [b, a] {
        let [x, y, z] = parts.positions[vertex as usize];
        parts.positions.push([x, y, z + 1.0]);
    }
    parts.faces.push(vec![a, b, next, next + 1]);
    parts.build()
}

/// A sheet with a vertex of valence 2 inside of a face.
fn valence_two() -> Result<ControlMesh> {
    let mut parts = sheet(4);
    let face = parts.faces[5].clone();
    let middle = parts.positions.len() as u32;
    parts.positions.push([1.4, 1.6, 0.3]);
    parts.faces[5] = vec![face[0], face[1], face[2], middle];
    parts.faces.push(vec![face[0], middle, face[2], face[3]]);
    parts.build()
}

fn kinds() -> impl Iterator<Item = Case> {
    KINDS.into_iter().flat_map(|(name, kind, make)| {
        SPACINGS.map(|spacing| {
            let levels = match name {
                "polygons" | "regular_irregular" => &LEVELS[..9],
                _ => &LEVELS[..],
            };
            let setup = Setup {
                spacings: vec![spacing],
                only: Some(kind),
                ..Setup::new(levels)
            };
            let name = format!("edges.kind.{name}-{}", spacing_name(spacing));
            case(name, setup, move |_| make())
        })
    })
}

fn valences() -> impl Iterator<Item = Case> {
    let setup = || Setup::new(&[1.0, 3.0, 8.0, 13.0]);
    let stars = [3, 5, 6, 7, 8, 12, 16, 31, 32, 33, 64].map(|n| {
        case(format!("edges.valence.quads-{n}"), setup(), move |_| {
            star(n).build()
        })
    });
    let poles = [3, 4, 5, 6, 7, 12, 16, 31, 32, 33, 48, 64].map(|n| {
        case(format!("edges.valence.triangles-{n}"), setup(), move |_| {
            builtin(&format!("pole-{n}"))
        })
    });
    let open = [1, 2, 3, 5, 8, 32].map(|n| {
        case(format!("edges.valence.boundary-{n}"), setup(), move |_| {
            open_star(n).build()
        })
    });
    // A single face shares nothing with anyone.
    let open = open.into_iter().skip(1);
    let polygons = [3, 5, 6, 8, 12, 20].map(|n| {
        case(format!("edges.valence.polygon-{n}"), setup(), move |_| {
            framed_polygon(n).build()
        })
    });
    stars.into_iter().chain(poles).chain(open).chain(polygons)
}

/// Every level alone, on a mesh of every kind of face.
fn levels() -> impl Iterator<Item = Case> {
    LEVELS.into_iter().flat_map(|level| {
        SPACINGS.map(|spacing| {
            let word = level.to_string().replace('.', "_");
            let setup = Setup {
                spacings: vec![spacing],
                ..Setup::new(&[level])
            };
            let name = format!("edges.level.{word}-{}", spacing_name(spacing));
            case(name, setup, |_| creased_polygons())
        })
    })
}

fn shapes() -> impl Iterator<Item = Case> {
    // Where 360 triangles meet, stencils have a thousand weights.
    let setup = Setup::new(&[3.0]);
    let pole = case("edges.shape.pole-360".into(), setup, |_| {
        builtin("pole-360")
    });
    let shapes = [
        "hull",
        "cube",
        "creased-torus",
        "sheet",
        "ngons",
        "cubes-2x1x1",
    ];
    let shapes = shapes.into_iter().flat_map(|shape| {
        SPACINGS.map(|spacing| {
            let setup = Setup {
                spacings: vec![spacing],
                ..Setup::new(&[1.0, 2.0, 3.0, 7.0, 8.0])
            };
            let name = format!("edges.shape.{shape}-{}", spacing_name(spacing));
            case(name, setup, move |_| builtin(shape))
        })
    });
    shapes.chain([pole])
}

const WAYS: [(&str, Drawn); 8] = [
    ("smallest_ring", Drawn::SmallestRing),
    ("ring_of_three", Drawn::SmallRing(3)),
    ("whole_ring", Drawn::WholeRing),
    ("host_slots", Drawn::Slots(Slots::Host)),
    ("counter_slots", Drawn::Slots(Slots::Counter)),
    ("one_at_a_time", Drawn::OneAtATime),
    ("100_vertices", Drawn::Batches(100)),
    ("1000_vertices", Drawn::Batches(1000)),
];

fn ways_of_drawing() -> impl Iterator<Item = Case> {
    WAYS.into_iter().flat_map(|(word, drawn)| {
        ["ngons", "creased-torus"].map(|shape| {
            let setup = Setup {
                drawn,
                ..Setup::new(&[3.0, 7.0])
            };
            let name = format!("edges.drawn.{word}-{shape}");
            case(name, setup, move |_| builtin(shape))
        })
    })
}

/// Plans that go less deep than the level asks for bound all patches alike, regular ones too.
fn plans() -> impl Iterator<Item = Case> {
    let shallow = [1, 2, 3, 4].into_iter().flat_map(|max_level| {
        ["hull", "ngons"].map(|shape| {
            let setup = Setup {
                options: MethodOptions::from(PlanOptions {
                    max_level,
                    ..Default::default()
                }),
                ..Setup::new(&[3.0, 8.0])
            };
            let name = format!("edges.plan.{max_level}_levels-{shape}");
            case(name, setup, move |_| builtin(shape))
        })
    });
    let refined = ["hull", "creased-torus"].map(|shape| {
        let setup = Setup {
            options: MethodOptions::from(PlanOptions {
                direct_creases: false,
                ..Default::default()
            }),
            ..Setup::new(&[3.0, 8.0])
        };
        let name = format!("edges.plan.refined_creases-{shape}");
        case(name, setup, move |_| builtin(shape))
    });
    shallow.chain(refined)
}

/// Tables of another level, and with other normals.
fn tables() -> impl Iterator<Item = Case> {
    let options = [
        ("level_2", 2, TableNormals::Shading(1)),
        ("shading_0", 5, TableNormals::Shading(0)),
        ("shading_2", 5, TableNormals::Shading(2)),
        ("geometric", 5, TableNormals::Geometric),
    ];
    options.into_iter().flat_map(|(word, level, normals)| {
        let meshes = [
            ("ngons", Scheme::CatmullClark),
            ("sheet", Scheme::Butterfly),
            ("pole-7", Scheme::LoopStam),
        ];
        meshes.map(|(shape, scheme)| {
            let setup = Setup {
                options: TableOptions { level, normals }.into(),
                ..Setup::new(&[1.0, 3.0, 8.0])
            };
            let name = format!("edges.tables.{word}-{shape}-{scheme}");
            case(name, setup, move |_| under(builtin(shape)?, scheme))
        })
    })
}

fn displaced() -> impl Iterator<Item = Case> {
    let shapes = ["hull", "ngons", "creased-torus", "sheet", "pole-64"];
    shapes.into_iter().map(|shape| {
        let setup = Setup {
            displacement: 0.05,
            ..Setup::new(&[1.0, 3.0, 8.0])
        };
        case(format!("edges.displaced.{shape}"), setup, move |_| {
            builtin(shape)
        })
    })
}

/// Scales and distances from the origin.
const PLACES: [(&str, f64, f64); 4] = [
    ("far", 0.1, 1000.0),
    ("tiny", 1e-9, 0.0),
    ("large", 1e9, 0.0),
    ("enormous", 1e25, 0.0),
];

fn places() -> impl Iterator<Item = Case> {
    PLACES.into_iter().map(|(word, scale, by)| {
        let setup = Setup::new(&[3.0, 8.0]);
        case(format!("edges.place.{word}"), setup, move |_| {
            moved(&builtin("hull")?, scale, by)
        })
    })
}

/// Random meshes, ten a case.
fn random() -> impl Iterator<Item = Case> {
    (0..20).map(|number| {
        let name = format!("edges.random.{number}");
        Case::new(name, RULE, SOURCE, move |context| {
            let mut compared = super::Compared::default();
            for mesh in 10 * number..10 * number + 10 {
                let model = Model::new(random_mesh(context, mesh)?);
                let setup = Setup::new(&[LEVELS[mesh as usize % 9], 3.0, 8.0]);
                let mut found = compare(context, &model, &setup)?;
                found.first = found.first.map(|first| format!("mesh {mesh}, {first}"));
                compared.add(found);
            }
            Ok(finding(&compared))
        })
    })
}
