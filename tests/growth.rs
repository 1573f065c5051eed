//! What small files with large neighbourhoods take: about as much as their size; and what grows like its square is refused at once where that is too much.
#![cfg(all(feature = "cli", target_os = "linux"))]

use std::f64::consts::TAU;

use hullform::mesh::{ControlMesh, Model, Scheme, Triangulation, triangulated};
use hullform::method::{MethodOptions, method_for};
use rustix::time::{ClockId, clock_gettime};

/// Positions, faces and creases of a shape of so many parts.
type Shape = (Vec<[f64; 3]>, Vec<Vec<u32>>, Vec<(u32, u32, f32)>);

fn circle(n: u32, z: f64) -> impl Iterator<Item = [f64; 3]> {
    (0..n).map(move |i| {
        let (y, x) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
        [x, y, z]
    })
}

fn pole(n: u32) -> Shape {
    let positions = [[0.0, 0.0, 1.0]].into_iter().chain(circle(n, 0.0));
    let faces = (0..n).map(|i| vec![0, 1 + i, 1 + (i + 1) % n]);
    (positions.collect(), faces.collect(), Vec::new())
}

fn quad_pole(n: u32) -> Shape {
    let positions = [[0.0, 0.0, 1.0]].into_iter().chain(circle(2 * n, 0.0));
    let faces = (0..n).map(|i| vec![0, 1 + 2 * i, 2 + 2 * i, 1 + (2 * i + 2) % (2 * n)]);
    (positions.collect(), faces.collect(), Vec::new())
}

/// A pole on a boundary.
fn half_pole(n: u32) -> Shape {
    let (positions, mut faces, creases) = quad_pole(n);
    faces.pop();
    (positions, faces, creases)
}

/// A pole whose spokes all differ, from smooth to very sharp whatever their number: sharper ones need deeper trees.
fn chain(n: u32) -> Shape {
    let (positions, faces, _) = quad_pole(n);
    let creases = (0..n).map(|i| (0, 1 + 2 * i, i as f32 / n as f32 * 9.0 + 0.01));
    (positions, faces, creases.collect())
}

/// A pole with a crease across it: a vertex of very many faces that is no hub.
fn divided_pole(n: u32) -> Shape {
    let (positions, faces, _) = quad_pole(n);
    let creases = [1, 1 + n / 2 * 2].map(|end| (0, end, 10.0));
    (positions, faces, creases.to_vec())
}

fn n_gon(n: u32) -> Shape {
    (circle(n, 0.0).collect(), vec![(0..n).collect()], Vec::new())
}

fn pillow(n: u32) -> Shape {
    let faces = vec![(0..n).collect(), (0..n).rev().collect()];
    (circle(n, 0.0).collect(), faces, Vec::new())
}

fn prism(n: u32) -> Shape {
    let positions = circle(n, 0.0).chain(circle(n, 1.0)).collect();
    let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|i| {
        let j = (i + 1) % n;
        vec![i, j, n + j, n + i]
    }));
    (positions, faces, Vec::new())
}

const SQUARE: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn copies(n: u32) -> Shape {
    let faces = vec![vec![0, 1, 2, 3]; n as usize];
    (SQUARE.to_vec(), faces, Vec::new())
}

fn two_sided(n: u32) -> Shape {
    let faces = (0..n).flat_map(|_| [vec![0, 1, 2, 3], vec![3, 2, 1, 0]]);
    (SQUARE.to_vec(), faces.collect(), Vec::new())
}

fn on_one_edge(n: u32) -> Shape {
    let pages = circle(n, 0.0).flat_map(|[x, y, _]| [[1.0, x, y], [0.0, x, y]]);
    let positions = [[0.0; 3], [1.0, 0.0, 0.0]].into_iter().chain(pages);
    let faces = (0..n).map(|i| vec![0, 1, 2 + 2 * i, 3 + 2 * i]);
    (positions.collect(), faces.collect(), Vec::new())
}

fn fans_at_one_vertex(n: u32) -> Shape {
    let ends = (0..n).flat_map(|i| [[f64::from(i), 1.0, 0.0], [f64::from(i), 1.0, 1.0]]);
    let positions = [[0.0; 3]].into_iter().chain(ends);
    let faces = (0..n).map(|i| vec![0, 1 + 2 * i, 2 + 2 * i]);
    (positions.collect(), faces.collect(), Vec::new())
}

fn mesh((positions, faces, creases): Shape) -> ControlMesh {
    let sizes: Vec<u32> = faces.iter().map(|face| face.len() as u32).collect();
    let mut builder = ControlMesh::builder(&positions, &sizes, &faces.concat());
    for (a, b, sharpness) in creases {
        builder = builder.crease(a, b, sharpness);
    }
    builder.build().expect("the shape is sound")
}

/// Seconds that this process computes for `work`, on one thread.
fn seconds<T: Send>(work: impl FnOnce() -> T + Send) -> (T, f64) {
    let now = || {
        let time = clock_gettime(ClockId::ProcessCPUTime);
        time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("one thread");
    let started = now();
    let result = pool.install(work);
    (result, now() - started)
}

type Named = (&'static str, fn(u32) -> Shape);

const SHAPES: [Named; 10] = [
    ("pole", pole),
    ("quad pole", quad_pole),
    ("chain", chain),
    ("n-gon", n_gon),
    ("prism", prism),
    ("on one edge", on_one_edge),
    ("fans at one vertex", fans_at_one_vertex),
    ("copies", copies),
    ("half pole", half_pole),
    ("two-sided", two_sided),
];

/// One test after the other: the process's time is measured.
#[test]
fn no_shape_takes_much_more_than_its_size() {
    for (name, shape) in SHAPES {
        let take = |n: u32| {
            let prepare = || {
                let model = Model::new(mesh(shape(n)));
                method_for(&model).prepare(&model, MethodOptions::default())
            };
            let (prepared, took) = seconds(prepare);
            assert!(prepared.is_ok(), "{name} of {n}");
            took
        };
        // Time varies by a third on machines with other work; the square would be 16 times as much.
        let [small, large] = [160, 640].map(|n| take(n).min(take(n)));
        println!("{name}: {small:.3} s, {large:.3} s");
        assert!(
            large < 6.5 * small.max(0.004),
            "{name}: {small} s, {large} s"
        );
    }
    let square: [Named; 2] = [("divided pole", divided_pole), ("pillow", pillow)];
    what_is_too_large_is_refused_at_once(square);
}

fn what_is_too_large_is_refused_at_once(square: [Named; 2]) {
    for (name, shape) in square {
        let model = Model::new(mesh(shape(20_000)));
        let ((), took) = seconds(|| {
            // The name of the default is that of the first that does what is asked for.
            let exact = hullform::method::METHODS.iter();
            let exact = exact.filter(|method| method.schemes.contains(&Scheme::CatmullClark));
            let refusal = exact
                .into_iter()
                .next()
                .expect("some do")
                .check_model(&model);
            let words = refusal.expect_err(name).to_string();
            let place = words.starts_with("vertex ") || words.starts_with("face ");
            assert!(place && words.contains("; "), "{name}: {words}");
        });
        assert!(took < 1.0, "{name}: {took} s");
    }
    let polygon = mesh(n_gon(20_000));
    let (triangles, took) = seconds(|| triangulated(&polygon, Triangulation::ShortestDiagonal));
    assert_eq!(triangles.expect("it is sound").face_count(), 19_998);
    assert!(took < 1.0, "{took} s");
}
