//! Methods that reach the limit on a lattice, at levels that have most of their vertices there.

use crate::conformance::Case;
use crate::conformance::capture::{SPACINGS, spacing_name};
use crate::conformance::limit::{Setup, case};
use crate::conformance::meshes::{framed_polygon, open_star, sheet, star, under};
use crate::error::Result;
use crate::mesh::{ControlMesh, builtin};
use crate::method::{METHODS, Reproduces};

type Make = fn() -> Result<ControlMesh>;

/// Closed ones, bounded ones, holes, and extraordinary vertices of every kind; none with creases.
const MESHES: [(&str, f32, Make); 12] = [
    ("cube", 16.0, || builtin("cube")),
    ("cube_at_full_level", 64.0, || builtin("cube")),
    ("sheet", 8.0, || sheet(6).build()),
    ("holes", 8.0, || builtin("sheet")),
    ("pole_3", 16.0, || builtin("pole-3")),
    ("pole_18", 16.0, || builtin("pole-18")),
    ("pole_40", 16.0, || builtin("pole-40")),
    ("star_5", 16.0, || star(5).build()),
    ("open_star_1", 16.0, || open_star(1).build()),
    ("open_star_7", 16.0, || open_star(7).build()),
    ("triangle", 16.0, || framed_polygon(3).build()),
    ("polygon_7", 16.0, || framed_polygon(7).build()),
];

pub(super) fn cases() -> impl Iterator<Item = Case> {
    let methods = METHODS
        .iter()
        .filter(|method| matches!(method.contract.reproduces, Reproduces::LimitOnLattice(_)));
    let schemes = methods.flat_map(|method| {
        let schemes = method.schemes.iter();
        schemes.map(move |&scheme| (method.name, scheme))
    });
    schemes.flat_map(|(method, scheme)| {
        let cuts = MESHES
            .into_iter()
            .flat_map(|mesh| SPACINGS.map(|spacing| (mesh, spacing)));
        cuts.map(move |((name, level, mesh), spacing)| {
            let setup = Setup {
                method: Some(method),
                ..Setup::new(level, spacing)
            };
            let spacing = spacing_name(spacing);
            let name = format!("limit.lattice.{method}-{scheme}-{name}-{spacing}");
            case(name, setup, move |_| under(mesh()?, scheme))
        })
    })
}
