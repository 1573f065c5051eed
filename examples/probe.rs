use glam::DVec3;
use hullform::mesh::read_obj;
use hullform::mesh::topology::Topology;
use hullform::subdivision::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mesh = read_obj(std::path::Path::new(&a[1])).unwrap();
    let s = LimitSurface::new(&mesh);
    let face: usize = a[2].parse().unwrap();
    let corner: u32 = a[3].parse().unwrap();
    let t = s.topology();
    let v = t.face(face as u32)[corner as usize];
    let fan = t.fan(face as u32, corner);
    println!(
        "vertex {v} sharp {} edges {:?} fan faces {} at {} closed {}",
        t.vertex_sharpness(v),
        t.vertex_edges(v)
            .iter()
            .map(|&e| t.edge(e).sharpness)
            .collect::<Vec<_>>(),
        fan.faces.len(),
        fan.at,
        fan.closed
    );
    let uv = [(0., 0.), (1., 0.), (1., 1.), (0., 1.)][corner as usize];
    let x = s.evaluate(face, uv.0, uv.1).unwrap();
    println!("ours {:?} du {:?} dv {:?}", x.normal(), x.du, x.dv);
    let mut topo: Topology = t.clone();
    let mut pos: Vec<DVec3> = mesh.positions().to_vec();
    let mut f = face as u32;
    let o = s.evaluate(face, uv.0, uv.1).unwrap().position;
    for p in pos.iter_mut() {
        *p -= o;
    }
    for k in 0..300 {
        let r = refine(&topo, &[(f, corner)]);
        pos = r
            .masks
            .iter()
            .map(|m| DVec3::blend(m, &pos) * 2.0)
            .collect();
        topo = r.topology;
        f = 0;
        let vs = topo.face(0);
        let c = corner as usize;
        let (p, n, q) = (
            pos[vs[c] as usize],
            pos[vs[(c + 1) % 4] as usize],
            pos[vs[(c + 3) % 4] as usize],
        );
        let nn = (n - p).normalize().cross((q - p).normalize()).normalize();
        if [0, 1, 5, 9, 10, 11, 20, 50, 100, 299].contains(&k) {
            println!(
                "{k} {nn:?} angle to ours {:.4}",
                nn.angle_between(x.normal()).to_degrees()
            );
        }
    }
}
