//! The figures and the table of Holländer, Boubekeur 2011.

use super::*;

/// How many frames of a method go into one of the faces themselves: the ratio of the rates that are printed.
fn rate(results: &Results, step: &str, method: &str) -> Option<f64> {
    results
        .times_flat(step, method, None)
        .map(|times| 1.0 / times)
}

/// In its order.
pub const FIGURES: &[Figure] = &[
    figure(
        "2011.figure.4",
        "Subdivision shading that starts at level 0, 1 and 2",
        steps(
            &[
                step(
                    "level-0",
                    "render any:monsterfrog/pole-7 --scheme loop --method bft --shading-level 0 --level ~32~8",
                    Writes::Picture,
                ),
                step(
                    "level-1",
                    "render any:monsterfrog/pole-7 --scheme loop --method bft --shading-level 1 --level ~32~8",
                    Writes::Picture,
                ),
                step(
                    "level-2",
                    "render any:monsterfrog/pole-7 --scheme loop --method bft --shading-level 2 --level ~32~8",
                    Writes::Picture,
                ),
            ],
            &[],
            "",
        ),
    ),
    figure(
        "2011.figure.5",
        "The tessellation unit as an adaptive subdivision mesher",
        steps(
            &[step(
                "wires",
                "render any:monsterfrog/pole-7 --scheme loop --method bft --adaptive screen --wireframe",
                Writes::Picture,
            )],
            &[],
            "",
        ),
    ),
    figure(
        "2011.figure.6",
        "Around an extraordinary vertex: QAS, Phong tessellation, PN triangles and tables",
        steps(
            &[step(
                "methods",
                "compare builtin:pole-12 --scheme loop --methods qas,phong,pn,bft --level 16 --backend pattern",
                Writes::Both,
            )],
            &[check(
                "distance of tables from the limit, the greatest, over the diagonal",
                "0: they lie on it",
                |r| r.error("methods", "bft", [POSITION, "maximum"]),
                Agrees::AtMost(1e-6),
            )],
            "",
        ),
    ),
    figure(
        "2011.figure.7",
        "Substitutes against the limit",
        steps(
            &[step(
                "methods",
                "compare any:bigguy/pole-18 --scheme loop --methods flat,phong,pn,qas,bft --level ~8~2",
                Writes::Both,
            )],
            &[
                check(
                    "distance of QAS over that of PN triangles, RMS",
                    "below 1",
                    |r| farther(r, "methods", ["qas", "pn"]),
                    Agrees::AtMost(1.0),
                ),
                check(
                    "distance of tables over that of QAS, RMS",
                    "0",
                    |r| farther(r, "methods", ["bft", "qas"]),
                    Agrees::AtMost(1e-2),
                ),
            ],
            "",
        ),
    ),
    figure(
        "2011.figure.8",
        "The cost of a triangle over levels",
        steps(
            &[step(
                "bench",
                "bench any:monsterfrog/pole-18 --scheme loop --methods bft --backend pattern --levels ~2,4,8,16,32~2,8 --frames ~4~2",
                Writes::Plot,
            )],
            &[check(
                "a vertex at level 8 over one at level 2",
                "below 1: deep levels cost less a triangle",
                |r| {
                    Some(
                        nanoseconds(r, "bench", "bft", 8.0)? / nanoseconds(r, "bench", "bft", 2.0)?,
                    )
                },
                Agrees::AtMost(1.0),
            )],
            "",
        ),
    ),
    figure(
        "2011.table.1",
        "Frame rates at level 5 over that of flat triangles (a third less to half again as much agrees)",
        steps(
            &[
                step(
                    "monsterfrog",
                    "bench model:monsterfrog --scheme loop --methods bft,qas,pn,phong --backend pattern --levels ~32~4 --frames ~4~2",
                    Writes::Plot,
                ),
                slow(
                    "bigguy",
                    "bench model:bigguy --scheme loop --methods bft,qas,pn,phong --backend pattern --levels 32 --frames 4",
                    Writes::Plot,
                ),
            ],
            &[
                check(
                    "Frog: tables",
                    "0.46",
                    |r| rate(r, "monsterfrog", "bft"),
                    Agrees::Between(0.31, 0.69),
                ),
                check(
                    "Frog: QAS",
                    "0.85",
                    |r| rate(r, "monsterfrog", "qas"),
                    Agrees::Between(0.57, 1.27),
                ),
                check(
                    "Frog: PN triangles",
                    "0.79",
                    |r| rate(r, "monsterfrog", "pn"),
                    Agrees::Between(0.53, 1.19),
                ),
                check(
                    "Frog: Phong tessellation",
                    "0.92",
                    |r| rate(r, "monsterfrog", "phong"),
                    Agrees::Between(0.61, 1.38),
                ),
                check(
                    "Big Guy: tables",
                    "0.47",
                    |r| rate(r, "bigguy", "bft"),
                    Agrees::Between(0.31, 0.70),
                ),
                check(
                    "Big Guy: QAS",
                    "0.51",
                    |r| rate(r, "bigguy", "qas"),
                    Agrees::Between(0.34, 0.77),
                ),
                check(
                    "Big Guy: PN triangles",
                    "0.78",
                    |r| rate(r, "bigguy", "pn"),
                    Agrees::Between(0.52, 1.17),
                ),
                check(
                    "Big Guy: Phong tessellation",
                    "0.89",
                    |r| rate(r, "bigguy", "phong"),
                    Agrees::Between(0.59, 1.33),
                ),
            ],
            "the models Head and Guy are not public",
        ),
    ),
];
