//! The figures of Brainerd et al. 2016 about macro faces (sections 7.3 and 9.4).

use super::super::figure::{Agrees, Make, Results, Writes};
use super::{check, slow, step, steps};

const STIRLING: &str = "Stirling is not public";

/// Faces a patch, those by themselves counted too.
fn faces_a_patch(results: &Results, step: &str) -> Option<f64> {
    let of = |name: &str| results.number(step, &format!("/macro_faces/{name}"));
    let single = of("other_irregular")? + of("other_regular")?;
    Some((of("faces_in_them")? + single) / (of("macro_faces")? + single))
}

/// The share of faces that are drawn together with others.
fn share(results: &Results, step: &str) -> Option<f64> {
    Some(results.number(step, "/macro_faces/faces_in_them")? / results.number(step, "/faces")?)
}

/// How many frames with macro faces one with single faces takes, with control points in a residence.
fn gain(
    results: &Results,
    [single, together]: [&str; 2],
    residence: &str,
    level: f64,
) -> Option<f64> {
    let time = |step: &str| {
        let row = results.row(step, "quadtree", Some(level), Some(residence))?;
        results.milliseconds(step, row)
    };
    Some(time(single)? / time(together)?)
}

/// Figure 7.
pub const RECTANGLE: Make = steps(
    &[step(
        "rectangles",
        "render builtin:sheet --macro rectangles --level 4 --shading node",
        Writes::Picture,
    )],
    &[],
    "",
);

/// Figure 8.
pub const RECTANGLES: Make = steps(
    &[
        step(
            "picture",
            "render any:armorguy/hull --macro rectangles --level 4 --shading patch",
            Writes::Picture,
        ),
        step(
            "bigguy",
            "plan any:bigguy/hull --macro rectangles",
            Writes::Facts,
        ),
        step(
            "armorguy",
            "plan any:armorguy/hull --macro rectangles",
            Writes::Facts,
        ),
        step("box", "plan box:12x12x12 --macro rectangles", Writes::Facts),
    ],
    &[
        check(
            "Big Guy: faces a patch",
            "6.3, of Stirling: 79,895 faces in 12,737 rectangles",
            |r| faces_a_patch(r, "bigguy"),
            Agrees::Shown,
        ),
        check(
            "Armor Guy: faces a patch",
            "6.3, of Stirling",
            |r| faces_a_patch(r, "armorguy"),
            Agrees::Shown,
        ),
        check(
            "a box of 12 by 12 faces a side: rectangles",
            "corners of valence 3 make six",
            |r| r.number("box", "/macro_faces/macro_faces"),
            Agrees::Exactly(6.0),
        ),
    ],
    STIRLING,
);

/// Figure 9.
pub const QUARTET: Make = steps(
    &[step(
        "quartets",
        "render builtin:sheet --macro quartets --level 4 --shading patch",
        Writes::Picture,
    )],
    &[],
    "",
);

/// Figure 10.
pub const QUARTETS: Make = steps(
    &[
        step(
            "picture",
            "render any:bigguy/hull --macro quartets --level 4 --shading patch",
            Writes::Picture,
        ),
        step(
            "bigguy",
            "plan any:bigguy/hull --macro quartets",
            Writes::Facts,
        ),
        step(
            "monsterfrog",
            "plan any:monsterfrog/hull --macro quartets",
            Writes::Facts,
        ),
        step(
            "armorguy",
            "plan any:armorguy/hull --macro quartets",
            Writes::Facts,
        ),
    ],
    &[
        check(
            "Big Guy: faces in quartets",
            "0.24 of all, of Stirling: 4,852 quartets, 46,110 irregular and 15,852 regular faces",
            |r| share(r, "bigguy"),
            Agrees::Shown,
        ),
        check(
            "Monster Frog: faces in quartets",
            "0.24 of all, of Stirling",
            |r| share(r, "monsterfrog"),
            Agrees::Shown,
        ),
        check(
            "Armor Guy: faces in quartets",
            "0.24 of all, of Stirling",
            |r| share(r, "armorguy"),
            Agrees::Shown,
        ),
    ],
    STIRLING,
);

/// Figure 16.
pub const STALLS: Make = Make::Cannot(
    "what runs on which of a device's processors no interface tells; `bench` tells what it comes to, see figure 17",
);

const SINGLE: &str = "bench ~box:32x32x32~box:4x4x4 --methods quadtree --levels 1,2,4 --frames ~20~2 --residence cache";
const RECTANGULAR: &str = "bench ~box:32x32x32~box:4x4x4 --methods quadtree --levels 1,2,4 --frames ~20~2 --residence cache --macro rectangles";
const FOURFOLD: &str = "bench ~box:32x32x32~box:4x4x4 --methods quadtree --levels 1,2,4 --frames ~20~2 --residence cache --macro quartets";

/// Figure 17: with control points that are computed beforehand, as there, and end to end.
pub const SPEED: Make = steps(
    &[
        step("single", SINGLE, Writes::Plot),
        step("rectangles", RECTANGULAR, Writes::Plot),
        step("quartets", FOURFOLD, Writes::Plot),
        slow(
            "bigguy-single",
            "bench model:bigguy --methods quadtree --levels 1,2,4 --frames 20 --residence ring,cache",
            Writes::Plot,
        ),
        slow(
            "bigguy-rectangles",
            "bench model:bigguy --methods quadtree --levels 1,2,4 --frames 20 --residence ring,cache --macro rectangles",
            Writes::Plot,
        ),
    ],
    &[
        check(
            "a box, level 1: frames with quartets in one with single faces",
            "more than 1, and less at level 4",
            |r| gain(r, ["single", "quartets"], "cache", 1.0),
            Agrees::AtLeast(1.0),
        ),
        check(
            "level 2",
            "more than 1",
            |r| gain(r, ["single", "quartets"], "cache", 2.0),
            Agrees::AtLeast(1.0),
        ),
        check(
            "level 4",
            "about 1",
            |r| gain(r, ["single", "quartets"], "cache", 4.0),
            Agrees::Shown,
        ),
        check(
            "a box, level 1: frames with rectangles in one with single faces",
            "more than 1",
            |r| gain(r, ["single", "rectangles"], "cache", 1.0),
            Agrees::AtLeast(1.0),
        ),
        check(
            "level 4",
            "about 1",
            |r| gain(r, ["single", "rectangles"], "cache", 4.0),
            Agrees::Shown,
        ),
        check(
            "Big Guy, level 4: frames with rectangles in one with single faces, stencils included",
            "no improvement, of models that are not trivial",
            |r| gain(r, ["bigguy-single", "bigguy-rectangles"], "ring", 4.0),
            Agrees::AtMost(1.1),
        ),
        check(
            "the same with control points that are there",
            "less than 1: the higher the level, the less",
            |r| gain(r, ["bigguy-single", "bigguy-rectangles"], "cache", 4.0),
            Agrees::Shown,
        ),
    ],
    "Stirling is not public, and the box stands for the torus",
);
