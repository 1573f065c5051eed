//! Group `robustness`: what is out of the ordinary does no harm.
//!
//! Levels that are no levels, draws of nothing, meshes without area, and tables whose bytes are garbage. A seeded fault gives the device an
//! ordinary level instead of an odd one, or expects a vertex more than there are.

use crate::conformance::capture::{bits, capturing, cut, prepare, vertices};
use crate::conformance::coordinates::{Shot, TessLevels, shoot, shoot_with};
use crate::conformance::meshes::{Parts, moved, sheet};
use crate::conformance::modes::{Domain, Modes, Spacing};
use crate::conformance::raw::{Raster, Recorder};
use crate::conformance::{Case, Check, Context, Finding, Group, LIMIT};
use crate::error::Result;
use crate::gpu::{Fill, Shading};
use crate::mesh::{ControlMesh, Model, builtin};
use crate::method::{Pass, Prepared};

/// The group.
pub const GROUP: Group = Group {
    name: "robustness",
    about: "odd levels, empty draws, degenerate meshes, corrupted tables",
    cases,
    model_cases: None,
};

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for domain in Domain::ALL {
        cases.extend(discards(domain));
        cases.extend(irrelevant(domain));
        cases.extend(inner(domain));
    }
    cases.extend(empty_draws());
    cases.extend(meshes());
    cases.extend(corrupted());
    cases
}

const DISCARD: &str = "Vulkan, Tessellator Patch Discard";

/// Outer levels that discard a patch.
const DISCARDING: [(&str, f32); 5] = [
    ("zero", 0.0),
    ("negative_zero", -0.0),
    ("negative", -3.0),
    ("negative_infinite", f32::NEG_INFINITY),
    ("nan", f32::NAN),
];

fn discards(domain: Domain) -> impl Iterator<Item = Case> {
    DISCARDING.into_iter().map(move |(word, level)| {
        let name = format!("robustness.discard.{}-{word}", domain.name());
        let rule = "a patch with such an outer level has no vertices, the one behind it has all of its own";
        Case::new(name, rule, DISCARD, move |context| {
            let level = if context.is_wrong() { 2.0 } else { level };
            let ordinary = TessLevels::uniform(4.0);
            let count = ordinary.outer(domain).len();
            let discarded = (0..count).map(|place| with_outer(place, level));
            let table: Vec<TessLevels> = discarded.chain([ordinary]).collect();
            let mut check = Check::default();
            for spacing in Spacing::ALL {
                let modes = Modes::new(domain, spacing);
                let shot = shoot(context, modes, &table, Raster::Solid)?;
                for (place, patch) in shot.patches[..count].iter().enumerate() {
                    check.hold(patch.is_empty(), || {
                        format!("level {level} of edge {place}: {} vertices", patch.len())
                    });
                }
                check.hold(!shot.patches[count].is_empty(), || {
                    "the patch behind them did not arrive".into()
                });
            }
            Ok(check.finish(format!("{count} edges, 3 spacings")))
        })
    })
}

fn with_outer(place: usize, level: f32) -> TessLevels {
    let mut levels = TessLevels::uniform(4.0);
    levels.outer[place] = level;
    levels
}

/// Outer levels that a domain does not have discard nothing. Quads have all of them.
fn irrelevant(domain: Domain) -> Option<Case> {
    let count = TessLevels::uniform(4.0).outer(domain).len();
    (count < 4).then(|| {
        let name = format!("robustness.discard.{}-irrelevant", domain.name());
        let rule = "an outer level that the domain does not have discards nothing";
        Case::new(name, rule, DISCARD, move |context| {
            let place = if context.is_wrong() { 0 } else { count };
            let odd = [0.0, -1.0, f32::NAN].map(|level| with_outer(place, level));
            let table = [odd.as_slice(), &[TessLevels::uniform(4.0)]].concat();
            let modes = Modes::new(domain, Spacing::Equal);
            let shot = shoot(context, modes, &table, Raster::Discard)?;
            Ok(like_the_last(&shot, "an irrelevant level"))
        })
    })
}

/// All patches have the vertices of the last one.
fn like_the_last(shot: &Shot, what: &str) -> Finding {
    let (last, others) = shot.patches.split_last().expect("there is a patch");
    let mut check = Check::default();
    for (number, patch) in others.iter().enumerate() {
        check.hold(!patch.is_empty() && patch.keys().eq(last.keys()), || {
            format!(
                "{what}, patch {number}: {} vertices instead of {}",
                patch.len(),
                last.len()
            )
        });
    }
    check.finish(format!("{} patches", others.len()))
}

/// Odd inner levels, and the ordinary ones that they count as; none where nobody says.
const INNER: [(&str, f32, Option<f32>); 5] = [
    ("zero", 0.0, Some(1.0)),
    ("negative", -5.0, Some(1.0)),
    ("negative_infinite", f32::NEG_INFINITY, Some(1.0)),
    ("infinite", f32::INFINITY, Some(64.0)),
    ("nan", f32::NAN, None),
];

fn inner(domain: Domain) -> Vec<Case> {
    if domain == Domain::Isolines {
        return Vec::new();
    }
    let case = |(word, level, same): (&str, f32, Option<f32>)| {
        let name = format!("robustness.inner.{}-{word}", domain.name());
        let rule =
            "inner levels are clamped to what the spacing allows; nothing of them discards a patch";
        let source = "Vulkan, Tessellator Spacing";
        Case::new(name, rule, source, move |context| {
            let with = |level| TessLevels {
                inner: [level; 2],
                ..TessLevels::uniform(5.0)
            };
            let given = if context.is_wrong() { 7.0 } else { level };
            let table = [with(given), with(same.unwrap_or(3.0))];
            let modes = Modes::new(domain, Spacing::Equal);
            let shot = shoot(context, modes, &table, Raster::Solid)?;
            if same.is_some() {
                return Ok(like_the_last(&shot, "an odd inner level"));
            }
            // What a NaN counts as is open; that the patch is whole on its edges is not.
            let count = shot.patches[0].len();
            let outline = TessLevels::uniform(5.0).outer(domain).len() * 5;
            let mut check = Check::default();
            check.hold(count >= outline && given != 7.0, || {
                format!("{count} vertices, {outline} on the edges")
            });
            Ok(check.finish(format!("{count} vertices")))
        })
    };
    INNER.map(case).into()
}

/// Draws that make so many patches. The last patch of each is an ordinary one, which must arrive.
struct EmptyDraw {
    name: &'static str,
    rule: &'static str,
    patches: usize,
    record: fn(&Recorder<'_>),
}

/// Patches have three control points here.
const EMPTY: [EmptyDraw; 5] = [
    EmptyDraw {
        name: "no_vertices",
        rule: "a draw of no vertices draws nothing",
        patches: 1,
        record: |cmd| {
            cmd.draw(0, 1, 0, 0);
            cmd.barrier();
            cmd.draw(3, 1, 0, 3);
        },
    },
    EmptyDraw {
        name: "no_instances",
        rule: "a draw of no instances draws nothing",
        patches: 1,
        record: |cmd| {
            cmd.draw(3, 0, 0, 0);
            cmd.barrier();
            cmd.draw(3, 1, 0, 3);
        },
    },
    EmptyDraw {
        name: "incomplete_patch",
        rule: "vertices too few for a patch draw nothing",
        patches: 1,
        record: |cmd| {
            cmd.draw(2, 1, 0, 0);
            cmd.barrier();
            cmd.draw(3, 1, 0, 3);
        },
    },
    EmptyDraw {
        name: "surplus_vertices",
        rule: "vertices behind the last whole patch draw nothing",
        patches: 4,
        record: |cmd| cmd.draw(5, 4, 0, 0),
    },
    EmptyDraw {
        name: "empty_between",
        rule: "empty draws between others leave these as they are",
        patches: 2,
        record: |cmd| {
            cmd.draw(3, 1, 0, 0);
            cmd.barrier();
            cmd.draw(0, 0, 0, 0);
            cmd.draw(1, 1, 0, 0);
            cmd.draw(3, 1, 0, 1);
        },
    },
];

fn empty_draws() -> impl Iterator<Item = Case> {
    EMPTY.iter().map(|draw| {
        let name = format!("robustness.empty.{}", draw.name);
        let source = "Vulkan, Drawing Commands; Patch Lists";
        Case::new(name, draw.rule, source, move |context| {
            let table = [TessLevels::uniform(3.0); 4];
            let modes = Modes::new(Domain::Quads, Spacing::Equal);
            let shot = shoot_with(context, modes, &table, Raster::Solid, 3, draw.record)?;
            let patches = shot.patches.iter().filter(|patch| !patch.is_empty());
            let (patches, wanted) = (patches.count(), draw.patches);
            let wanted = wanted + usize::from(context.is_wrong());
            let mut check = Check::default();
            check.hold(patches == wanted, || {
                format!("{patches} patches instead of {wanted}")
            });
            Ok(check.finish(format!("{patches} patches")))
        })
    })
}

/// How a mesh that nobody wants is made.
type Make = fn() -> Result<ControlMesh>;

const MESHES: [(&str, f32, Make); 10] = [
    ("one_point", 9.0, || collapsed([0.0; 3])),
    ("one_line", 9.0, || collapsed([1.0, 0.0, 0.0])),
    ("one_plane", 9.0, || collapsed([1.0, 1.0, 0.0])),
    ("folded", 9.0, || {
        sheet_of(|[x, y, z]| [(x - 2.0).abs(), y, z])
    }),
    ("needle", 9.0, || {
        sheet_of(|[x, y, z]| [1e6 * x, 1e-6 * y, z])
    }),
    ("enormous", 9.0, || moved(&builtin("hull")?, 1e30, 0.0)),
    ("tiny", 9.0, || moved(&builtin("hull")?, 1e-30, 0.0)),
    ("longest_ring", 5.0, || builtin("pole-1000")),
    ("single_face", 64.0, || sheet(1).build()),
    ("many_faces", 1.0, || builtin("cubes-20x20x20")),
];

fn collapsed(keep: [f64; 3]) -> Result<ControlMesh> {
    sheet_of(|p| [0, 1, 2].map(|i| p[i] * keep[i]))
}

fn sheet_of(place: impl Fn([f64; 3]) -> [f64; 3]) -> Result<ControlMesh> {
    let Parts { positions, faces } = sheet(4);
    let positions = positions.into_iter().map(place).collect();
    Parts { positions, faces }.build()
}

fn meshes() -> impl Iterator<Item = Case> {
    MESHES.into_iter().map(|(word, level, make)| {
        let name = format!("robustness.mesh.{word}");
        let rule = "every vertex arrives, with finite positions, and normals of length 1 or 0";
        let source = "Brainerd et al. 2016, section 4; IEEE 754";
        let case = Case::new(name, rule, source, move |context| {
            odd_mesh(context, &Model::new(make()?), level)
        });
        // The longest ring of all takes a busy software device more than a minute.
        case.within(3 * LIMIT)
    })
}

fn odd_mesh(context: &Context, model: &Model, level: f32) -> Result<Finding> {
    let mut check = Check::default();
    let cut = cut(level, crate::tessellation::Spacing::Equal);
    let prepared = prepare(model, "quadtree")?;
    let expected = vertices(&prepared, cut) as usize + usize::from(context.is_wrong());
    let options = capturing(context, &prepared, cut);
    let bench = context.bench()?;
    let mut loaded = bench.load(model, prepared, &context.workarounds()?, options)?;
    let frame = loaded.capture(cut, Fill::Solid(Shading::Patch))?;
    let all: Vec<_> = frame.passes.iter().flatten().collect();
    check.hold(all.len() == expected, || {
        format!("{} vertices instead of {expected}", all.len())
    });
    for vertex in &all {
        let length: f32 = vertex.normal.iter().map(|x| x * x).sum();
        let sound = vertex.position.iter().all(|x| x.is_finite())
            && (length == 0.0 || (length - 1.0).abs() < 1e-4);
        check.hold(sound, || format!("{vertex:?}"));
    }
    Ok(check.finish(format!("{} vertices", all.len())))
}

/// What is spoiled: words of one of the tables that the shaders read.
#[derive(Clone, Copy, Debug)]
enum Spoiled {
    Table(usize),
    Controls,
    Patches,
}

const SPOILED: [(&str, Spoiled); 10] = [
    ("nodes", Spoiled::Table(0)),
    ("points", Spoiled::Table(1)),
    ("stencils", Spoiled::Table(2)),
    ("weights", Spoiled::Table(3)),
    ("patterns", Spoiled::Table(4)),
    ("uses", Spoiled::Table(5)),
    ("ends", Spoiled::Table(6)),
    ("borders", Spoiled::Table(7)),
    ("controls", Spoiled::Controls),
    ("patches", Spoiled::Patches),
];

fn corrupted() -> impl Iterator<Item = Case> {
    SPOILED.into_iter().flat_map(|(word, spoiled)| {
        ["ngons", "creased-torus"].map(|shape| {
            let name = format!("robustness.corrupted.{word}-{shape}");
            let rule = "with robust buffer access, garbage in a table ends in no crash and no hang, and the device draws on as before";
            let source = "Vulkan, robustBufferAccess";
            Case::new(name, rule, source, move |context| {
                corrupt(context, shape, spoiled, word)
            })
        })
    })
}

fn corrupt(context: &Context, shape: &str, spoiled: Spoiled, word: &str) -> Result<Finding> {
    const ROUNDS: u32 = 6;
    let model = Model::new(builtin(shape)?);
    let cut = cut(6.0, crate::tessellation::Spacing::Equal);
    let (bench, workarounds) = (context.robust_bench()?, context.workarounds()?);
    let draw = |prepared: Prepared| {
        // Options of the sound model: what the host knows is not spoiled.
        let options = capturing(context, &prepare(&model, "quadtree")?, cut);
        let mut loaded = bench.load(&model, prepared, &workarounds, options)?;
        loaded.capture(cut, Fill::Discard)
    };
    let mut random = context.random(&format!("robustness.corrupted.{word}"));
    let before = draw(prepare(&model, "quadtree")?)?;
    let mut changed = 0;
    for round in 0..ROUNDS {
        let mut prepared = prepare(&model, "quadtree")?;
        for pass in &mut prepared.passes {
            changed += spoil(pass, spoiled, 1 << round, |end| {
                (random.bits() as u32, random.below(end))
            });
        }
        draw(prepared)?;
    }
    let after = draw(prepare(&model, "quadtree")?)?;
    let mut check = Check::default();
    check.hold(changed > 0, || "no word was changed".into());
    let counts = [&before, &after].map(|frame| frame.passes.iter().map(Vec::len).sum::<usize>());
    check.hold(counts[0] == counts[1] && counts[0] > 0, || {
        format!("{} vertices before, {} afterwards", counts[0], counts[1])
    });
    let vertices = before.passes.iter().flatten();
    for (vertex, right) in after.passes.iter().flatten().zip(vertices) {
        let mut found = bits(vertex);
        found[3] ^= u32::from(context.is_wrong());
        check.hold(found == bits(right), || {
            format!("afterwards {vertex:?} instead of {right:?}")
        });
    }
    Ok(check.finish(format!("{ROUNDS} rounds, {changed} words changed")))
}

/// Replaces up to `count` words of a table by random ones; `draw` gives such a word, and a number below its argument.
fn spoil(
    pass: &mut Pass,
    spoiled: Spoiled,
    count: u32,
    mut draw: impl FnMut(u32) -> (u32, u32),
) -> u32 {
    let words: &mut [u32] = match spoiled {
        Spoiled::Table(table) => match pass.tables.get_mut(table) {
            Some(words) => words,
            None => return 0,
        },
        Spoiled::Controls => &mut pass.controls,
        Spoiled::Patches => bytemuck::cast_slice_mut(&mut pass.patches),
    };
    for _ in 0..count {
        let (word, place) = draw(words.len() as u32);
        words[place as usize] = word;
    }
    count
}
