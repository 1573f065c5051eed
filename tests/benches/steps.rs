//! What each step from a file's bytes to tables takes, beside a reader that does nothing but `strtof` and `strtol`.
//!
//! `cargo bench --bench steps`; models are read from `../shared/models`, where the folder exists.

// What criterion makes of its macros has no documentation.
#![allow(missing_docs)]

use std::ffi::{CStr, c_char, c_float, c_int, c_long};
use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use hullform::mesh::topology::Topology;
use hullform::mesh::{ControlMesh, Model, builtin, read_obj_bytes, replicated};
use hullform::method::method_for;
use hullform::plan::PlanOptions;

unsafe extern "C" {
    fn strtof(text: *const c_char, end: *mut *mut c_char) -> c_float;
    fn strtol(text: *const c_char, end: *mut *mut c_char, base: c_int) -> c_long;
}

/// The plainest reader there is: it believes everything, and keeps positions, arities and vertices.
#[derive(Default)]
struct Plainest {
    positions: Vec<f32>,
    sizes: Vec<u32>,
    vertices: Vec<u32>,
}

fn plainest(text: &CStr) -> Plainest {
    let mut read = Plainest::default();
    let mut at = text.as_ptr();
    // SAFETY: `at` stays within the text: it moves on only behind what was read there, and never past the zero at its end, where both functions stop too.
    unsafe {
        while *at != 0 {
            match [*at as u8, *at.add(1) as u8] {
                [b'v', b' '] => {
                    at = at.add(1);
                    for _ in 0..3 {
                        let mut end = std::ptr::null_mut();
                        read.positions.push(strtof(at, &mut end));
                        at = end;
                    }
                }
                [b'f', b' '] => {
                    at = at.add(1);
                    let mut corners = 0;
                    loop {
                        let mut end = std::ptr::null_mut();
                        let vertex = strtol(at, &mut end, 10);
                        if std::ptr::eq(end, at) || *at == b'\n' as c_char {
                            break;
                        }
                        at = end;
                        read.vertices.push(vertex as u32 - 1);
                        corners += 1;
                        while !matches!(*at as u8, b' ' | b'\n' | 0) {
                            at = at.add(1);
                        }
                    }
                    read.sizes.push(corners);
                }
                _ => {}
            }
            while !matches!(*at as u8, b'\n' | 0) {
                at = at.add(1);
            }
            at = at.add(usize::from(*at != 0));
        }
    }
    read
}

/// A model's name and text.
fn models() -> Vec<(&'static str, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    let read = |name: &'static str| Some((name, std::fs::read(folder.join(name)).ok()?));
    let found: Vec<_> = ["bigguy.obj", "armorguy.obj"]
        .into_iter()
        .filter_map(read)
        .collect();
    if found.is_empty() {
        println!("skipped: there is no {}", folder.display());
    }
    found
}

fn reading(criterion: &mut Criterion) {
    for (name, text) in models() {
        let mut group = criterion.benchmark_group(format!("reading {name}"));
        group.throughput(Throughput::Bytes(text.len() as u64));
        group.bench_function("read_obj_bytes", |bencher| {
            bencher.iter(|| read_obj_bytes(name, black_box(&text)).expect("it is sound"));
        });
        let ended = [&text[..], b"\n\0"].concat();
        let ended = CStr::from_bytes_with_nul(&ended).expect("a text has no zeros");
        group.bench_function("strtof", |bencher| {
            bencher.iter(|| plainest(black_box(ended)))
        });
    }
}

fn meshes() -> Vec<(String, ControlMesh)> {
    let read = |(name, text): (&str, Vec<u8>)| {
        let mesh = read_obj_bytes(name, &text).expect("it is sound");
        (name.to_string(), mesh)
    };
    let mut meshes: Vec<_> = models().into_iter().map(read).collect();
    let hull = builtin("hull").expect("it is built in");
    let many = replicated(&hull, 20).expect("twenty are not many");
    meshes.extend([("hull".to_string(), hull), ("hull x 20".to_string(), many)]);
    meshes
}

fn preparing(criterion: &mut Criterion) {
    for (name, mesh) in meshes() {
        let mut group = criterion.benchmark_group(format!("preparing {name}"));
        group.throughput(Throughput::Elements(mesh.face_count() as u64));
        group.bench_function("topology", |bencher| {
            bencher.iter(|| Topology::new(black_box(&mesh)));
        });
        let model = Model::new(mesh.clone());
        group.bench_function("prepare", |bencher| {
            let method = method_for(&model);
            bencher.iter(|| method.prepare(black_box(&model), PlanOptions::default()));
        });
    }
}

criterion_group! {
    name = steps;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    targets = reading, preparing
}
criterion_main!(steps);
