use glam::*;
use hullform::mesh::*;
use hullform::method::*;
use hullform::subdivision::*;
fn main() {
    for f in std::env::args().skip(1) {
        let mesh = match read_obj(std::path::Path::new(&f)) {
            Ok(m) => m,
            Err(e) => {
                println!("{e}");
                continue;
            }
        };
        let (lo, hi) = mesh.bounds();
        let diag = lo.distance(hi);
        let t = std::time::Instant::now();
        let model = Model::new(mesh);
        let t1 = t.elapsed().as_secs_f64();
        let p = (method("quadtree").unwrap().prepare)(&model, Default::default()).unwrap();
        let st = p.plans.as_ref().unwrap();
        println!(
            "{f}: topo {t1:.3} build {:.3} reg {} irr {} plans {} nodes {:?} stencils {} qb {} sb {} cp {:?}",
            st.build_seconds,
            st.regular,
            st.irregular,
            st.plans,
            st.nodes,
            st.stencils,
            st.quadtree_bytes,
            st.stencil_bytes,
            &st.control_points[..7]
        );
        let truth = LimitSurface::new(model.mesh());
        let pos = model.positions();
        let mut worst = (0f64, 0f64, String::new(), String::new());
        let mut count = 0;
        for pass in &p.passes {
            let step = 1.max(pass.patches.len() / 200);
            for i in (0..pass.patches.len()).step_by(step) {
                let patch = pass.patches[i];
                for &level in &[1, 2, 3, 5, 7, 8, 13, 64] {
                    for a in 0..=level {
                        for b in 0..=level {
                            if level > 8 && (a * 31 + b * 17) % 11 != 0 && a != 1 && b != 1 {
                                continue;
                            }
                            let uv = [a as f32 / level as f32, b as f32 / level as f32];
                            let s = pass.evaluate(&pos, i, Vec2::from(uv));
                            let [u, v] = to_ptex(&patch, uv);
                            let tr = truth
                                .evaluate(patch.ptex as usize, u as f64, v as f64)
                                .unwrap();
                            count += 1;
                            let d = (s.position.as_dvec3() + model.centre()).distance(tr.position)
                                / diag;
                            let n = tr.normal();
                            let sn = s.normal().as_dvec3();
                            let ang = if n.length() < 0.5 || sn.length() < 0.5 {
                                0.0
                            } else {
                                sn.angle_between(n).to_degrees()
                            };
                            if d > worst.0 || d.is_nan() {
                                worst.0 = d;
                                worst.2 = format!(
                                    "{} {u} {v} ptex {} level {level}",
                                    pass.shader, patch.ptex
                                )
                            }
                            if ang > worst.1 {
                                worst.1 = ang;
                                worst.3 = format!("{} {u} {v} ptex {}", pass.shader, patch.ptex)
                            }
                        }
                    }
                }
            }
        }
        println!(
            "   pos {:.2e} ({}) normal {:.4} ({}) samples {count}",
            worst.0, worst.2, worst.1, worst.3
        );
    }
}
