//! All cases, by group.

use glob::Pattern;

use crate::conformance::{
    Case, Group, backends, barriers, compute_visibility, connectivity, coordinates, determinism,
    draws, edges, geometry, io, limit, loops, precision, primitive_id, robustness, scale, state,
    statistics, visibility, winding, witness,
};
use crate::error::{Error, Result};

/// Every group.
pub const GROUPS: &[Group] = &[
    coordinates::GROUP,
    connectivity::GROUP,
    winding::GROUP,
    limit::GROUP,
    witness::GROUP,
    edges::GROUP,
    backends::GROUP,
    scale::GROUP,
    draws::GROUP,
    primitive_id::GROUP,
    io::GROUP,
    state::GROUP,
    geometry::GROUP,
    barriers::GROUP,
    loops::GROUP,
    precision::GROUP,
    visibility::GROUP,
    determinism::GROUP,
    statistics::GROUP,
    robustness::GROUP,
    compute_visibility::GROUP,
];

/// A part of each group that is quick and whose cases no driver is known to fail: before the names of these cases `smoke.` may stand in a filter.
pub const SMOKE: [&str; 42] = [
    "coordinates.quads-equal.*",
    "coordinates.triangles-fractional_odd.*",
    "limit.valence.boundary-[1-5]",
    "limit.kind.*-equal",
    "witness.*.cube",
    "witness.cusp.[12]",
    "witness.plane.quadtree-*",
    "edges.kind.s*-equal",
    "edges.picture-*.[bc]*-equal",
    "backends.same.*-qas-*-cube",
    "backends.tags.*-bft-loop-cube-*",
    "scale.*.draw-1025_patches-*-from_70000",
    "scale.vertices_per_batch.*-1023_patches-*",
    "visibility.coherent.*",
    "determinism.[!c]*.ngons-equal",
    "statistics.*.*s-equal",
    "robustness.*.quads-*",
    "connectivity.*.quads-fractional_odd-between-some",
    "connectivity.*.triangles-equal-whole-some",
    "connectivity.lines.*-inner-one",
    "connectivity.f*.quads-equal-whole-some",
    "winding.triangles.quads-equal-*-cull_[nf]*",
    "winding.points.*-fractional_even-*",
    "winding.lines.*-equal-*",
    "draws.remainder.*-3_points-*",
    "draws.empty.*",
    "draws.several.*-17_commands-*",
    "primitive_id.written.*-64_patches-*",
    "primitive_id.[gh]*-7_patches-*",
    "io.vertices.3_in-4_out",
    "io.greatest.4_vertices",
    "state.points.3-*",
    "state.[dlrs]*.1",
    "state.optimised.1",
    "state.views.*-two-*_reads",
    "geometry.*.quads-fractional_odd-*",
    "geometry.[fs]*.quads-*",
    "barriers.[vb]*.3_invocations-1_*",
    "loops.*.tested_first",
    "precision.*.de_casteljau-*",
    "precision.invariant.*-unit",
    "compute_visibility.*-300_patches",
];

/// Cases to run, in order.
#[derive(Debug)]
pub struct Registry {
    /// The cases.
    pub cases: Vec<Case>,
}

impl Registry {
    /// The whole suite.
    pub fn suite() -> Registry {
        Registry {
            cases: GROUPS.iter().flat_map(|group| (group.cases)()).collect(),
        }
    }

    /// What the suite has for the user's meshes of these names.
    pub fn of_models<'a>(names: impl IntoIterator<Item = &'a str> + Clone) -> Registry {
        let groups = GROUPS.iter().filter_map(|group| group.model_cases);
        let cases = groups.flat_map(|cases| names.clone().into_iter().flat_map(cases));
        Registry {
            cases: cases.collect(),
        }
    }

    /// Keeps the cases whose names match a pattern; `*` stands for dots as well. Those of [`SMOKE`] have a second name, with `smoke.` before it.
    ///
    /// # Errors
    /// [`Error::Option`] for what is no pattern, or matches nothing: a filter with a typing error shall not pass.
    pub fn filter(&mut self, pattern: &str) -> Result<()> {
        let refused = |problem: String| Error::Option {
            option: "--filter",
            problem,
            remedy: "see `hullform verify --list` for the names; `*` stands for any part of one"
                .into(),
        };
        let compiled = Pattern::new(pattern)
            .map_err(|error| refused(format!("'{pattern}' is no pattern: {error}")))?;
        let smoke = SMOKE.map(|part| Pattern::new(part).expect("tests read every part"));
        self.cases.retain(|Case { name, .. }| {
            let is_smoke = || smoke.iter().any(|part| part.matches(name));
            compiled.matches(name) || compiled.matches(&format!("smoke.{name}")) && is_smoke()
        });
        if self.cases.is_empty() {
            return Err(refused(format!("no case matches '{pattern}'")));
        }
        Ok(())
    }

    /// The case of a name.
    pub fn find(&self, name: &str) -> Option<&Case> {
        self.cases.iter().find(|case| case.name == name)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn names_are_unique_and_have_three_parts() {
        let suite = Registry::suite();
        let mut seen = BTreeSet::new();
        for case in &suite.cases {
            assert!(seen.insert(&case.name), "{} is there twice", case.name);
            let parts: Vec<&str> = case.name.split('.').collect();
            assert_eq!(parts.len(), 3, "{}", case.name);
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "_-".contains(c);
            assert!(
                parts.iter().all(|part| part.chars().all(plain)),
                "{}",
                case.name
            );
            assert!(GROUPS.iter().any(|group| group.name == parts[0]));
            assert!(!case.rule.is_empty() && !case.source.is_empty());
        }
        assert!(seen.len() >= 3000, "thousands of cases, not {}", seen.len());
    }

    #[test]
    fn no_group_is_empty() {
        for group in GROUPS {
            assert!((group.cases)().len() >= 10, "{}", group.name);
        }
    }

    #[test]
    fn filters_keep_what_they_name() {
        let mut suite = Registry::suite();
        suite.filter("scale.*").expect("there are such");
        assert!(
            suite
                .cases
                .iter()
                .all(|case| case.name.starts_with("scale."))
        );
        assert!(suite.filter("no.such.case").is_err());
        assert!(Registry::suite().filter("[").is_err());
    }

    #[test]
    fn a_part_of_each_group_is_smoke() {
        let mut smoke = Registry::suite();
        smoke.filter("smoke.*").expect("there are such");
        assert!((100..500).contains(&smoke.cases.len()));
        for group in GROUPS {
            let own = format!("smoke.{}.*", group.name);
            Registry::suite().filter(&own).expect("each has some");
        }
        for part in SMOKE {
            smoke.filter(part).expect("each part has some");
            smoke = Registry::suite();
        }
    }

    #[test]
    fn every_workaround_names_cases_that_are_there() {
        let suite = Registry::suite();
        for row in crate::gpu::workaround::WORKAROUNDS {
            let own = suite
                .cases
                .iter()
                .filter(|case| case.name.starts_with(row.case));
            assert!(own.count() > 0, "{}", row.case);
        }
    }

    #[test]
    fn meshes_of_the_user_have_cases_of_their_own() {
        let cases = Registry::of_models(["ship", "car"]).cases;
        assert!(cases.iter().any(|case| case.name.contains("ship")));
        assert!(cases.iter().any(|case| case.name.starts_with("limit.")));
        assert!(
            cases
                .iter()
                .any(|case| case.name.starts_with("statistics."))
        );
    }
}
