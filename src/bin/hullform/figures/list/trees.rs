//! The figures and tables of Brainerd, Foley, Kraemer, Moreton, Nießner 2016.

use super::*;

const PLANS: [Step; 3] = [
    step("bigguy", "plan model:bigguy", Writes::Facts),
    step("monsterfrog", "plan model:monsterfrog", Writes::Facts),
    step("armorguy", "plan model:armorguy", Writes::Facts),
];

/// The share of a frame that goes into control points: what a frame that finds them in the cache does without.
fn stencil_share(results: &Results, level: f64) -> Option<f64> {
    let [ring, cache] = ["ring", "cache"].map(|residence| {
        let row = results.row("bench", "quadtree", Some(level), Some(residence))?;
        results.milliseconds("bench", row)
    });
    Some(1.0 - cache? / ring?)
}

/// How many frames of the second method go into one of the first.
fn times(results: &Results, step: &str, [method, of]: [&str; 2], level: f64) -> Option<f64> {
    let [own, other] = [method, of].map(|method| results.times_flat(step, method, Some(level)));
    Some(own? / other?)
}

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
        steps(
            &[
                step(
                    "bigguy",
                    "bench model:bigguy --methods quadtree,gregory,fas,refine --levels ~1,2,3,4,5,6,7,8~1,8 --frames ~9~3",
                    Writes::Plot,
                ),
                slow(
                    "monsterfrog",
                    "bench model:monsterfrog --methods quadtree,gregory,fas --levels 1,2,3,4,5,6,7,8 --frames 9",
                    Writes::Plot,
                ),
                slow(
                    "armorguy",
                    "bench model:armorguy --methods quadtree,fas --levels 1,2,4,8 --frames 4",
                    Writes::Plot,
                ),
            ],
            &[
                check(
                    "Big Guy, level 8: frames of quadtree in one of fas",
                    "1.2 to 3.4, of all models",
                    |r| times(r, "bigguy", ["fas", "quadtree"], 8.0),
                    Agrees::AtLeast(1.2),
                ),
                check(
                    "Monster Frog, level 8: frames of quadtree in one of fas",
                    "1.2 to 3.4, of all models",
                    |r| times(r, "monsterfrog", ["fas", "quadtree"], 8.0),
                    Agrees::AtLeast(1.2),
                ),
                check(
                    "Big Guy, level 8: frames of quadtree in one of refine",
                    "not printed",
                    |r| times(r, "bigguy", ["refine", "quadtree"], 8.0),
                    Agrees::Shown,
                ),
                check(
                    "Armor Guy, level 8: frames of quadtree in one of fas",
                    "1.2 to 3.4, of all models",
                    |r| times(r, "armorguy", ["fas", "quadtree"], 8.0),
                    Agrees::AtLeast(1.2),
                ),
                check(
                    "Big Guy, level 8: frames of gregory in one of quadtree",
                    "on par with Gregory patches",
                    |r| times(r, "bigguy", ["quadtree", "gregory"], 8.0),
                    Agrees::AtMost(1.25),
                ),
                check(
                    "Monster Frog, level 8: frames of gregory in one of quadtree",
                    "on par with Gregory patches",
                    |r| times(r, "monsterfrog", ["quadtree", "gregory"], 8.0),
                    Agrees::AtMost(1.25),
                ),
            ],
            "DFAS and OpenSubdiv are not in the library, and Stirling is not public",
        ),
    ),
    figure(
        "2016.figure.13",
        "A grid of cubes, which has irregular faces alone",
        steps(
            &[step(
                "cubes",
                "bench ~builtin:cubes-12x12x10~builtin:cubes-4x4x3 --methods quadtree,gregory,fas --levels ~1,2,4,8~8 --frames ~4~2",
                Writes::Plot,
            )],
            &[
                check(
                    "level 8: frames of quadtree in one of fas",
                    "more than 3",
                    |r| times(r, "cubes", ["fas", "quadtree"], 8.0),
                    Agrees::AtLeast(3.0),
                ),
                check(
                    "level 8: frames of gregory in one of quadtree",
                    "not printed",
                    |r| times(r, "cubes", ["quadtree", "gregory"], 8.0),
                    Agrees::Shown,
                ),
            ],
            "",
        ),
    ),
    figure(
        "2016.figure.14",
        "The share of a frame that goes into stencils, Armor Guy",
        steps(
            &[slow(
                "bench",
                "bench model:armorguy --methods quadtree --residence ring,cache --static --levels 1,2,4,8 --frames 4",
                Writes::Plot,
            )],
            &[
                check(
                    "level 1",
                    "at most 0.54",
                    |r| stencil_share(r, 1.0),
                    Agrees::AtMost(0.54),
                ),
                check(
                    "level 8",
                    "at least 0.30, and falling with the level",
                    |r| stencil_share(r, 8.0),
                    Agrees::AtMost(0.54),
                ),
                check(
                    "level 8 over level 1",
                    "below 1",
                    |r| Some(stencil_share(r, 8.0)? / stencil_share(r, 1.0)?),
                    Agrees::AtMost(1.0),
                ),
            ],
            "",
        ),
    ),
    figure(
        "2016.figure.15",
        "Levels by distance, Big Guy",
        steps(
            &[
                step(
                    "near",
                    "render any:bigguy/hull --adaptive distance --shading level --camera=40,22,1",
                    Writes::Picture,
                ),
                step(
                    "far",
                    "render any:bigguy/hull --adaptive distance --shading level --camera=40,22,0.25",
                    Writes::Picture,
                ),
            ],
            &[],
            "DFAS, which it is compared with, is not in the library",
        ),
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
