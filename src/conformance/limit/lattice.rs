//! Methods that reach the limit on a lattice, at levels that have most of their vertices there.

use crate::conformance::Case;
use crate::conformance::capture::{SPACINGS, spacing_name};
use crate::conformance::limit::{Setup, case};
use crate::conformance::meshes::{framed_polygon, open_star, sheet, star, under};
use crate::error::Result;
use crate::mesh::{ControlMesh, Scheme, builtin};
use crate::method::{METHODS, Method, Reproduces, TableNormals, TableOptions};
use crate::tessellation::Spacing;

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

/// What `tables` looks at: every other level of the lattice, and each source of normals.
const TABLES: [(&str, u32, TableNormals); 6] = [
    ("level_1", 1, TableNormals::Shading(1)),
    ("level_3", 3, TableNormals::Shading(1)),
    ("level_6", 6, TableNormals::Shading(1)),
    ("shading_0", 5, TableNormals::Shading(0)),
    ("shading_2", 5, TableNormals::Shading(2)),
    ("geometric", 5, TableNormals::Geometric),
];

/// Closed ones, then bounded ones.
const TABLE_MESHES: [(&str, Make); 3] = [
    ("cube", || builtin("cube")),
    ("pole_18", || builtin("pole-18")),
    ("holes", || builtin("sheet")),
];

/// The options of tables.
pub(super) fn tables() -> impl Iterator<Item = Case> {
    let methods = METHODS.iter().filter(|method| method.uses_tables);
    let schemes = methods.flat_map(|method| {
        let schemes = method.schemes.iter();
        schemes.map(move |&scheme| (method, scheme))
    });
    schemes.flat_map(|(method, scheme)| {
        TABLES.into_iter().flat_map(move |(word, level, normals)| {
            let options = TableOptions { level, normals };
            let meshes = TABLE_MESHES.into_iter();
            meshes
                .filter(move |&(name, _)| has_normals(scheme, name, normals))
                .map(move |(name, mesh)| table_case(method, scheme, (word, options), (name, mesh)))
        })
    })
}

/// Butterfly limits have no tangent plane at boundary vertices of other than three faces.
fn has_normals(scheme: Scheme, mesh: &str, normals: TableNormals) -> bool {
    (scheme, mesh, normals) != (Scheme::Butterfly, "holes", TableNormals::Geometric)
}

fn table_case(
    method: &Method,
    scheme: Scheme,
    (word, options): (&str, TableOptions),
    (name, mesh): (&str, Make),
) -> Case {
    let setup = Setup {
        method: Some(method.name),
        options: options.into(),
        ..Setup::new(8.0, Spacing::Equal)
    };
    let name = format!("limit.tables.{}-{scheme}-{name}-{word}", method.name);
    case(name, setup, move |_| under(mesh()?, scheme))
}
