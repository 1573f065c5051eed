//! Driver faults that decide how we draw, as data.
//!
//! A row says which drivers have the fault, what we do about it and which conformance case shows it, so that anyone can find
//! out whether a row is still needed. To add a driver's fault, add a row; no other code asks which driver it runs on.

use crate::gpu::driver::{Driver, Version};
use ash::vk;

/// What we do about a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remedy {
    /// At most `max_vertices` tessellated vertices an instance: a draw of many patches becomes instances of few.
    SplitBatches {
        /// The most vertices that the evaluation shader may run for in one instance.
        max_vertices: u32,
    },
    /// Patch numbers come from `gl_VertexIndex` and `gl_InstanceIndex`, never from `gl_PrimitiveID`.
    ///
    /// Our shaders do so on every driver, so there is nothing to switch: the row explains it to those who write their own.
    PatchNumberFromVertices,
    /// Queries begin behind a pipeline that is bound, where anything has pushed constants before: what decides, fills caches or computes points does.
    ///
    /// `host` does so on every driver, so there is nothing to switch: the row explains it to engines with queries of their own.
    PipelineBeforeQuery,
}

/// A row of the table: a driver's fault and its remedy.
#[derive(Debug)]
pub struct Workaround {
    /// What reports and `hullform devices` call it.
    pub name: &'static str,
    /// The driver with the fault.
    pub driver: vk::DriverId,
    /// The first version without the fault; `None` while no such version is known.
    pub fixed: Option<Version>,
    /// Where the fault was seen with our own eyes.
    pub seen: &'static str,
    /// What goes wrong without the remedy.
    pub reason: &'static str,
    /// The conformance case that shows it.
    pub case: &'static str,
    /// What we do about it.
    pub remedy: Remedy,
}

/// Every known fault.
///
/// Versions before the first one tested count as faulty too: the remedies are right everywhere, and merely slower.
pub const WORKAROUNDS: &[Workaround] = &[
    Workaround {
        name: "split-batches",
        driver: vk::DriverId::MESA_LLVMPIPE,
        fixed: None,
        seen: "Mesa 22.3.6 and 25.0.7",
        reason: "more than 65,535 tessellated vertices in one internal batch lose patches and take run-away time",
        case: "scale.vertices_per_batch",
        remedy: Remedy::SplitBatches {
            max_vertices: 65_535,
        },
    },
    Workaround {
        name: "patch-number-from-vertices",
        driver: vk::DriverId::MESA_LLVMPIPE,
        fixed: None,
        seen: "Mesa 22.3.6 and 25.0.7",
        reason: "gl_PrimitiveID starts again at every internal batch of a draw",
        case: "scale.primitive_id",
        remedy: Remedy::PatchNumberFromVertices,
    },
    Workaround {
        name: "pipeline-before-query",
        driver: vk::DriverId::MESA_LLVMPIPE,
        fixed: Some(Version(25, 0, 7)),
        seen: "Mesa 22.3.6, not in 25.0.7",
        reason: "a query that begins behind pushed constants and before a pipeline is bound ends the process",
        case: "statistics.begun",
        remedy: Remedy::PipelineBeforeQuery,
    },
];

impl Workaround {
    /// Whether `driver` has this fault.
    pub fn applies_to(&self, driver: &Driver) -> bool {
        self.driver == driver.id && self.fixed.is_none_or(|fixed| driver.version < fixed)
    }
}

/// The rows that apply to `driver`.
pub fn workarounds(driver: &Driver) -> Vec<&'static Workaround> {
    WORKAROUNDS
        .iter()
        .filter(|row| row.applies_to(driver))
        .collect()
}

/// The most tessellated vertices that an instance may hold under `active`; `None` if no row sets a limit.
pub fn instance_vertices(active: &[&Workaround]) -> Option<u32> {
    let limits = active.iter().filter_map(|row| match row.remedy {
        Remedy::SplitBatches { max_vertices } => Some(max_vertices),
        Remedy::PatchNumberFromVertices | Remedy::PipelineBeforeQuery => None,
    });
    limits.min()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driver(id: vk::DriverId, version: Version) -> Driver {
        Driver {
            id,
            name: String::new(),
            info: String::new(),
            version,
        }
    }

    #[test]
    fn every_known_lavapipe_splits_batches() {
        for version in [Version(0, 0, 0), Version(22, 3, 6), Version(25, 3, 0)] {
            let rows = workarounds(&driver(vk::DriverId::MESA_LLVMPIPE, version));
            assert_eq!(instance_vertices(&rows), Some(65_535));
        }
    }

    #[test]
    fn other_drivers_need_nothing() {
        assert!(workarounds(&driver(vk::DriverId::MESA_RADV, Version(22, 3, 6))).is_empty());
        assert_eq!(instance_vertices(&[]), None);
        assert_eq!(instance_vertices(&[&WORKAROUNDS[0]]), Some(65_535));
    }

    #[test]
    fn a_fault_ends_with_the_version_that_fixed_it() {
        let row = &WORKAROUNDS[2];
        assert!(row.applies_to(&driver(row.driver, Version(25, 0, 6))));
        assert!(!row.applies_to(&driver(row.driver, Version(25, 0, 7))));
    }
}
