//! Methods that reach the limit at six places of each triangle, at levels that have vertices there.

use crate::conformance::Case;
use crate::conformance::limit::{Setup, case};
use crate::conformance::meshes::{creased_sheet, framed_polygon, open_star, sheet, star, under};
use crate::error::Result;
use crate::mesh::{ControlMesh, SchemeOptions, builtin};
use crate::method::{METHODS, Reproduces};
use crate::tessellation::Spacing;

type Make = fn() -> Result<ControlMesh>;

/// Closed ones, bounded ones, creases that go through and creases that end, corners, holes.
const MESHES: [(&str, Make); 9] = [
    ("cube", || builtin("cube")),
    ("sheet", || sheet(5).build()),
    ("corners_and_holes", || builtin("sheet")),
    ("star_5", || star(5).build()),
    ("open_star_1", || open_star(1).build()),
    ("open_star_7", || open_star(7).build()),
    ("crease", || creased(6)),
    ("dart", || creased(3)),
    ("polygons", || framed_polygon(7).build()),
];

fn creased(edges: u32) -> Result<ControlMesh> {
    creased_sheet(10.0, edges, SchemeOptions::default())
}

pub(super) fn cases() -> impl Iterator<Item = Case> {
    let methods = METHODS
        .iter()
        .filter(|method| matches!(method.contract.reproduces, Reproduces::LimitOnHexagon(_)));
    let schemes = methods.flat_map(|method| {
        let schemes = method.schemes.iter();
        schemes.map(move |&scheme| (method.name, scheme))
    });
    schemes.flat_map(|(method, scheme)| {
        let setup = Setup {
            method: Some(method),
            ..Setup::new(2.0, Spacing::Equal)
        };
        let meshes = MESHES.map(move |(name, mesh)| {
            let name = format!("limit.hexagon.{method}-{scheme}-{name}");
            case(name, setup, move |_| under(mesh()?, scheme))
        });
        let poles = (3..=18).map(move |n| {
            let name = format!("limit.hexagon.{method}-{scheme}-pole_{n}");
            case(name, setup, move |_| {
                under(builtin(&format!("pole-{n}"))?, scheme)
            })
        });
        meshes.into_iter().chain(poles)
    })
}
