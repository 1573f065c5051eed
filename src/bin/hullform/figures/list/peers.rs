//! The figures of Brainerd et al. 2016 that measure against what there was before (section 9).

use super::super::figure::{Agrees, Make, Results, Writes};
use super::{check, slow, step, steps};

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

/// The same of levels of their own, whoever decides them.
fn slower(results: &Results, step: &str, [method, of]: [&str; 2]) -> Option<f64> {
    let time = |method: &str| results.milliseconds(step, results.row(step, method, None, None)?);
    Some(time(method)? / time(of)?)
}

/// Figure 11.
pub const FACTORS: Make = steps(
    &[
        step(
            "bigguy",
            "bench model:bigguy --methods quadtree,gregory,fas,dfas,refine --levels ~1,2,3,4,5,6,7,8~1,8 --frames ~9~3",
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
            "Big Guy, level 8: frames of fas in one of dfas",
            "more than 1: overhead",
            |r| times(r, "bigguy", ["dfas", "fas"], 8.0),
            Agrees::Shown,
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
    "OpenSubdiv is not in the library, and Stirling is not public",
);

/// Figure 13.
pub const CUBES: Make = steps(
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
);

/// Figure 14.
pub const SHARE: Make = steps(
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
);

/// Figure 15. Levels by pixels fall with the distance as well, whatever the model's units.
pub const DISTANCE: Make = steps(
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
        step(
            "bench-near",
            "bench any:bigguy/hull --methods quadtree,fas,dfas --adaptive screen:4 --camera=40,22,4 --levels ~32~8 --frames ~4~2",
            Writes::Facts,
        ),
        step(
            "bench-far",
            "bench any:bigguy/hull --methods quadtree,fas,dfas --adaptive screen:4 --camera=40,22,0.5 --levels ~32~8 --frames ~4~2",
            Writes::Facts,
        ),
    ],
    &[
        check(
            "near: frames of quadtree in one of dfas",
            "more than 1, at every distance",
            |r| slower(r, "bench-near", ["dfas", "quadtree"]),
            Agrees::AtLeast(1.0),
        ),
        check(
            "far: frames of quadtree in one of dfas",
            "more than 1, at every distance",
            |r| slower(r, "bench-far", ["dfas", "quadtree"]),
            Agrees::AtLeast(1.0),
        ),
        check(
            "near: frames of dfas in one of fas, whose depth is that of the greatest level",
            "not printed",
            |r| slower(r, "bench-near", ["fas", "dfas"]),
            Agrees::Shown,
        ),
        check(
            "far: frames of dfas in one of fas",
            "not printed",
            |r| slower(r, "bench-far", ["fas", "dfas"]),
            Agrees::Shown,
        ),
    ],
    "",
);
