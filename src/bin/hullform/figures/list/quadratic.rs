//! The figures and the table of Boubekeur, Schlick 2007.

use super::*;

/// In its order.
pub const FIGURES: &[Figure] = &[
    figure(
        "2007.figure.1",
        "The coarse mesh, the approximation, and Loop's limit",
        steps(
            &[step(
                "methods",
                "compare any:monsterfrog/pole-18 --scheme loop --methods flat,qas,bft --level ~8~2",
                Writes::Both,
            )],
            &[check(
                "distance from the limit over that of the coarse mesh, RMS",
                "almost indistinguishable",
                |r| farther(r, "methods", ["qas", "flat"]),
                Agrees::AtMost(0.25),
            )],
            "",
        ),
    ),
    figure(
        "2007.figure.2",
        "Six points of each triangle on the limit",
        steps(
            &[step(
                "points",
                "compare any:monsterfrog/pole-18 --scheme loop --methods qas --level 2 --backend pattern",
                Writes::Both,
            )],
            &[check(
                "distance of the six from the limit, the greatest, over the diagonal",
                "0",
                |r| r.error("points", "qas", [POSITION, "maximum"]),
                Agrees::AtMost(1e-6),
            )],
            "",
        ),
    ),
    figure(
        "2007.figure.3",
        "Adaptive rendering",
        steps(
            &[
                step(
                    "wires",
                    "render any:monsterfrog/pole-18 --scheme loop --method qas --adaptive screen --wireframe",
                    Writes::Picture,
                ),
                step(
                    "lit",
                    "render any:monsterfrog/pole-18 --scheme loop --method qas --adaptive screen",
                    Writes::Picture,
                ),
            ],
            &[],
            "",
        ),
    ),
    figure(
        "2007.figure.4",
        "Against curved PN triangles",
        steps(
            &[step(
                "methods",
                "compare any:monsterfrog/pole-18 --scheme loop --methods flat,pn,qas --level ~8~2",
                Writes::Both,
            )],
            &[check(
                "distance from the limit over that of PN triangles, RMS",
                "a far better quality",
                |r| farther(r, "methods", ["qas", "pn"]),
                Agrees::AtMost(0.5),
            )],
            "",
        ),
    ),
    figure(
        "2007.figure.5",
        "Triangles a second at depth 5",
        steps(
            &[step(
                "bench",
                "bench any:monsterfrog/pole-18 --scheme loop --methods qas --backend pattern --levels ~32~8 --frames ~4~2",
                Writes::Plot,
            )],
            &[check(
                "nanoseconds a vertex",
                "2.9 to 3.8 a triangle",
                |r| {
                    nanoseconds(
                        r,
                        "bench",
                        "qas",
                        if r.row("bench", "qas", Some(32.0), None).is_some() {
                            32.0
                        } else {
                            8.0
                        },
                    )
                },
                Agrees::Shown,
            )],
            "the printed rates are those of a GeForce 8800 GTX, and the models are not public",
        ),
    ),
    figure(
        "2007.table.1",
        "Against Shiue's kernel",
        steps(
            &[step(
                "bench",
                "bench any:monsterfrog/pole-18 --scheme loop --methods qas --levels 32 --frames ~4~2",
                Writes::Facts,
            )],
            &[
                check(
                    "draw commands of a frame at level 5, all in one render pass",
                    "1 rendering pass",
                    |r| r.row("bench", "qas", None, None)?["draws"].as_f64(),
                    Agrees::Shown,
                ),
                check(
                    "points that are computed by control shaders",
                    "none: no input process on the GPU",
                    |r| r.row("bench", "qas", None, None)?["points_computed"].as_f64(),
                    Agrees::Exactly(0.0),
                ),
            ],
            "Shiue's kernel, the other column, is not in the library",
        ),
    ),
];
