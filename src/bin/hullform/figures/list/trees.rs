//! The figures and tables of Brainerd, Foley, Kraemer, Moreton, Nießner 2016.

use super::*;

const PLANS: [Step; 3] = [
    step("bigguy", "plan model:bigguy", Writes::Facts),
    step("monsterfrog", "plan model:monsterfrog", Writes::Facts),
    step("armorguy", "plan model:armorguy", Writes::Facts),
];

/// Nodes and stencils of all plans.
fn size(results: &Results, step: &str) -> Option<f64> {
    let nodes = results.0.get(step)?.get("nodes")?.as_object()?;
    let nodes: Option<f64> = nodes.values().map(|count| count.as_f64()).sum();
    Some(nodes? + results.number(step, "/stencils")?)
}

/// In its order.
pub const FIGURES: &[Figure] = &[
    figure(
        "2016.figure.2",
        "A face with an extraordinary vertex: one primitive with a hierarchy inside",
        steps(
            &[
                step("tree", "plan box:2x2x2 --face 0", Writes::Drawing),
                step(
                    "levels",
                    "render box:2x2x2 --method fas --shading patch",
                    Writes::Picture,
                ),
            ],
            &[],
            "its transition patches are cut in several domains; ours have edges of twice the level instead",
        ),
    ),
    figure(
        "2016.figure.3",
        "Tessellation patterns side by side: one primitive a face, feature-adaptive subdivision, uniform refinement",
        steps(
            &[
                step(
                    "quadtree",
                    "render box:2x2x2 --wireframe --level 6 --shading patch --size 560x560 --camera=45,35,1.5",
                    Writes::Panel,
                ),
                step(
                    "fas",
                    "render box:2x2x2 --method fas --wireframe --level 6 --shading patch --size 560x560 --camera=45,35,1.5",
                    Writes::Panel,
                ),
                step(
                    "refine",
                    "render box:2x2x2 --method refine --wireframe --level 6 --shading patch --size 560x560 --camera=45,35,1.5",
                    Writes::Panel,
                ),
            ],
            &[],
            "",
        ),
    ),
    figure(
        "2016.figure.5",
        "The quadtree of a face with two extraordinary vertices and a semi-sharp edge, and with direct evaluation",
        steps(
            &[
                step(
                    "recursive",
                    "plan crease:2x1x1 --face 2 --no-direct-creases",
                    Writes::Drawing,
                ),
                step("direct", "plan crease:2x1x1 --face 2", Writes::Drawing),
            ],
            &[],
            "",
        ),
    ),
    figure(
        "2016.figure.6",
        "A terminal node at an extraordinary vertex",
        steps(
            &[
                step("tree", "plan box:2x2x2 --face 0", Writes::Drawing),
                step("plan", "plan box:2x2x2", Writes::Facts),
            ],
            &[check(
                "internal nodes of a tree with one extraordinary vertex",
                "none: the terminal node stands for all levels",
                |r| r.number("plan", "/nodes/internal"),
                Agrees::Exactly(0.0),
            )],
            "",
        ),
    ),
    figure(
        "2016.figure.7",
        "A rectangular macro face",
        together::RECTANGLE,
    ),
    figure(
        "2016.figure.8",
        "Stirling with rectangular macro faces",
        together::RECTANGLES,
    ),
    figure("2016.figure.9", "A regular quartet", together::QUARTET),
    figure(
        "2016.figure.10",
        "Stirling with quartets",
        together::QUARTETS,
    ),
    figure(
        "2016.figure.11",
        "The time of a frame over tessellation factors, against Gregory patches",
        peers::FACTORS,
    ),
    figure(
        "2016.figure.13",
        "A grid of cubes, which has irregular faces alone",
        peers::CUBES,
    ),
    figure(
        "2016.figure.14",
        "The share of a frame that goes into stencils, Armor Guy",
        peers::SHARE,
    ),
    figure(
        "2016.figure.15",
        "Levels by distance, Big Guy",
        peers::DISTANCE,
    ),
    figure(
        "2016.figure.16",
        "Stalls of hull shaders with macro faces",
        together::STALLS,
    ),
    figure(
        "2016.figure.17",
        "The speed of macro faces",
        together::SPEED,
    ),
    figure(
        "2016.figure.18",
        "A creased torus without and with direct evaluation",
        steps(
            &[
                step(
                    "torus",
                    "render builtin:creased-torus --shading node",
                    Writes::Picture,
                ),
                step(
                    "recursive",
                    "plan builtin:creased-torus --no-direct-creases",
                    Writes::Facts,
                ),
                step("direct", "plan builtin:creased-torus", Writes::Facts),
            ],
            &[check(
                "nodes and stencils without it over those with it",
                "6.5, of a torus with creases of sharpness 4.7",
                |r| Some(size(r, "recursive")? / size(r, "direct")?),
                Agrees::AtLeast(2.0),
            )],
            "",
        ),
    ),
    figure(
        "2016.table.2",
        "Models: faces, regular and irregular ones (here patches: an n-gon has several)",
        steps(
            &PLANS,
            &[
                check(
                    "Big Guy: faces",
                    "1450",
                    |r| r.number("bigguy", "/faces"),
                    Agrees::Exactly(1450.0),
                ),
                check(
                    "Big Guy: regular",
                    "858",
                    |r| r.number("bigguy", "/regular"),
                    Agrees::Exactly(858.0),
                ),
                check(
                    "Big Guy: irregular",
                    "592",
                    |r| r.number("bigguy", "/irregular"),
                    Agrees::Exactly(592.0),
                ),
                check(
                    "Monster Frog: faces",
                    "1284",
                    |r| r.number("monsterfrog", "/faces"),
                    Agrees::Exactly(1284.0),
                ),
                check(
                    "Monster Frog: regular",
                    "510",
                    |r| r.number("monsterfrog", "/regular"),
                    Agrees::Exactly(510.0),
                ),
                check(
                    "Monster Frog: irregular",
                    "774",
                    |r| r.number("monsterfrog", "/irregular"),
                    Agrees::Exactly(774.0),
                ),
                check(
                    "Armor Guy: faces",
                    "8639",
                    |r| r.number("armorguy", "/faces"),
                    Agrees::Exactly(8639.0),
                ),
                check(
                    "Armor Guy: regular",
                    "962",
                    |r| r.number("armorguy", "/regular"),
                    Agrees::Exactly(962.0),
                ),
                check(
                    "Armor Guy: irregular",
                    "7677",
                    |r| r.number("armorguy", "/irregular"),
                    Agrees::Exactly(7677.0),
                ),
            ],
            "Stirling is not public",
        ),
    ),
    figure(
        "2016.table.3",
        "Direct against recursive evaluation of creases, a torus",
        steps(
            &[
                step(
                    "recursive",
                    "plan builtin:creased-torus --no-direct-creases",
                    Writes::Facts,
                ),
                step("direct", "plan builtin:creased-torus", Writes::Facts),
            ],
            &[
                check(
                    "nodes and stencils, recursive",
                    "8,634",
                    |r| size(r, "recursive"),
                    Agrees::Shown,
                ),
                check(
                    "nodes and stencils, direct",
                    "1,338",
                    |r| size(r, "direct"),
                    Agrees::Shown,
                ),
                check(
                    "what direct evaluation saves",
                    "0.84",
                    |r| Some(1.0 - size(r, "direct")? / size(r, "recursive")?),
                    Agrees::AtLeast(0.5),
                ),
            ],
            "the torus is not the paper's, and Stirling is not public",
        ),
    ),
    figure(
        "2016.table.4",
        "Memory: plans, quadtrees, stencils, scratch (a quarter more than printed agrees)",
        steps(
            &PLANS,
            &[
                check(
                    "Big Guy: plans",
                    "19",
                    |r| r.number("bigguy", "/plans"),
                    Agrees::AtMost(19.0),
                ),
                check(
                    "Big Guy: quadtree bytes",
                    "21 KB",
                    |r| r.number("bigguy", "/bytes/quadtree"),
                    Agrees::AtMost(26_000.0),
                ),
                check(
                    "Big Guy: stencil bytes",
                    "346 KB",
                    |r| r.number("bigguy", "/bytes/stencils"),
                    Agrees::AtMost(433_000.0),
                ),
                check(
                    "Big Guy: scratch bytes",
                    "1.6 MB",
                    |r| r.number("bigguy", "/bytes/scratch_worst_case"),
                    Agrees::AtMost(2e6),
                ),
                check(
                    "Monster Frog: plans",
                    "70",
                    |r| r.number("monsterfrog", "/plans"),
                    Agrees::AtMost(70.0),
                ),
                check(
                    "Monster Frog: quadtree bytes",
                    "76 KB",
                    |r| r.number("monsterfrog", "/bytes/quadtree"),
                    Agrees::AtMost(95_000.0),
                ),
                check(
                    "Monster Frog: stencil bytes",
                    "1.1 MB",
                    |r| r.number("monsterfrog", "/bytes/stencils"),
                    Agrees::AtMost(1.4e6),
                ),
                check(
                    "Monster Frog: scratch bytes",
                    "2.2 MB",
                    |r| r.number("monsterfrog", "/bytes/scratch_worst_case"),
                    Agrees::AtMost(2.8e6),
                ),
                check(
                    "Armor Guy: plans",
                    "2,099",
                    |r| r.number("armorguy", "/plans"),
                    Agrees::AtMost(2099.0),
                ),
                check(
                    "Armor Guy: quadtree bytes",
                    "2.7 MB",
                    |r| r.number("armorguy", "/bytes/quadtree"),
                    Agrees::AtMost(3.4e6),
                ),
                check(
                    "Armor Guy: stencil bytes",
                    "25 MB",
                    |r| r.number("armorguy", "/bytes/stencils"),
                    Agrees::AtMost(31.3e6),
                ),
                check(
                    "Armor Guy: scratch bytes",
                    "21 MB",
                    |r| r.number("armorguy", "/bytes/scratch_worst_case"),
                    Agrees::AtMost(26.3e6),
                ),
            ],
            "Stirling is not public",
        ),
    ),
];
