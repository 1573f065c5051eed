//! How far a captured surface is from what it is compared with.

use std::collections::HashMap;

use glam::{DVec3, Vec2};
use hullform::mesh::{Model, Placement};
use hullform::method::{Controls, Pass, Prepared, from_ptex};
use hullform::subdivision::LimitSurface;
use indicatif::ProgressBar;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::output::{Point, Surface};

/// Position in local units and unit normal; the normal is zero where there is none.
pub type Sample = (DVec3, DVec3);

/// A point of a ptex face, by its bits.
type Key = (u32, [u32; 2]);

/// What methods are compared with.
pub enum Reference {
    /// The limit in f64, and where its mesh lies.
    Truth(Box<LimitSurface>, Placement),
    /// Another method, by its twin on the CPU: it can be asked at any point, wherever its own tessellator puts vertices.
    Method(Box<Twin>),
}

/// A prepared method to be asked by ptex face.
pub struct Twin {
    prepared: Prepared,
    controls: Controls,
    /// Pass and patch of each part of each ptex face.
    patches: HashMap<u32, Vec<(usize, usize)>>,
}

impl Twin {
    /// The twin of a prepared model.
    pub fn new(model: &Model, prepared: Prepared) -> Twin {
        let mut patches: HashMap<u32, Vec<(usize, usize)>> = HashMap::new();
        for (number, pass) in prepared.passes.iter().enumerate() {
            for (patch, record) in pass.patches.iter().enumerate() {
                patches
                    .entry(record.ptex)
                    .or_default()
                    .push((number, patch));
            }
        }
        Twin {
            patches,
            controls: prepared.controls(model.positions()),
            prepared,
        }
    }
}

impl Twin {
    /// The patch that has a point of a ptex face, and where in its domain: the last one where rounding leaves the point between several.
    fn find(&self, face: u32, uv: [f32; 2]) -> Option<(&Pass, usize, [f32; 2])> {
        let mut parts = self.patches.get(&face)?.iter().map(|&(pass, patch)| {
            let pass = &self.prepared.passes[pass];
            (pass, patch, from_ptex(&pass.patches[patch], uv))
        });
        let last = parts.clone().next_back();
        parts
            .find(|(pass, _, uv)| pass.domain.contains(*uv))
            .or(last)
    }
}

impl Reference {
    /// Position in local units and normal at a point of a ptex face; None where there is no surface.
    pub fn evaluate(&self, face: u32, uv: [f32; 2]) -> Option<Sample> {
        match self {
            Reference::Truth(limit, placement) => {
                let [u, v] = uv.map(f64::from);
                let sample = limit.evaluate(face as usize, u, v)?;
                Some((placement.local(sample.position), sample.normal()))
            }
            Reference::Method(twin) => {
                let (pass, patch, uv) = twin.find(face, uv)?;
                let sample = pass.evaluate(&twin.controls, patch, Vec2::from(uv));
                Some((sample.position.as_dvec3(), sample.normal.as_dvec3()))
            }
        }
    }
}

/// A reference with the points that were already asked for: methods share most of their points.
pub struct Known {
    reference: Reference,
    samples: HashMap<Key, Option<Sample>>,
}

impl Known {
    /// Nothing is known yet.
    pub fn new(reference: Reference) -> Known {
        Known {
            reference,
            samples: HashMap::new(),
        }
    }

    /// Learns whatever points of a surface are not known yet.
    pub fn learn(&mut self, surface: &Surface, bar: &ProgressBar) {
        let keys = surface.points.iter().map(key);
        let mut new: Vec<Key> = keys.filter(|key| !self.samples.contains_key(key)).collect();
        new.sort_unstable();
        new.dedup();
        bar.set_length(new.len() as u64);
        let asked = new.into_par_iter().map(|key| {
            let sample = self.reference.evaluate(key.0, key.1.map(f32::from_bits));
            bar.inc(1);
            (key, sample)
        });
        let asked: Vec<_> = asked.collect();
        self.samples.extend(asked);
    }

    fn sample(&self, point: &Point) -> Option<Sample> {
        self.samples.get(&key(point)).copied().flatten()
    }
}

fn key(point: &Point) -> Key {
    (point.face, point.uv.map(f32::to_bits))
}

/// The errors at every point of a surface; None where there is nothing to compare with.
pub struct Errors {
    /// Distance to the reference at the same (ptex face, u, v), over the diagonal of the control mesh's bounding box.
    pub positions: Vec<Option<f64>>,
    /// Angle to the reference's normal there, in degrees.
    pub normals: Vec<Option<f64>>,
    /// Of the positions.
    pub position: Summary,
    /// Of the normals.
    pub normal: Summary,
}

impl Errors {
    /// Compares all points of a surface with what is known there.
    pub fn new(surface: &Surface, known: &Known, model: &Model) -> Errors {
        // A model without extent has only errors of nothing.
        let diagonal = model.diagonal().max(f64::MIN_POSITIVE);
        let local = |point: &Point| model.placement().local(point.position.into());
        let samples: Vec<Option<Sample>> = surface.points.iter().map(|p| known.sample(p)).collect();
        let pairs = || surface.points.iter().zip(&samples);
        let positions: Vec<Option<f64>> = pairs()
            .map(|(point, sample)| {
                let (position, _) = sample.as_ref()?;
                Some(local(point).distance(*position) / diagonal)
            })
            .collect();
        let normals: Vec<Option<f64>> = pairs()
            .map(|(point, sample)| {
                let (_, normal) = sample.as_ref()?;
                angle(DVec3::from(point.normal.map(f64::from)), *normal)
            })
            .collect();
        let points: Vec<DVec3> = surface.points.iter().map(local).collect();
        let areas = areas(&points, &surface.triangles);
        Errors {
            position: Summary::new(&positions, &areas),
            normal: Summary::new(&normals, &areas),
            positions,
            normals,
        }
    }
}

/// Degrees between two directions; None if one of them is none. By the arc tangent: an arc cosine knows nothing below 1e-6 degrees.
fn angle(a: DVec3, b: DVec3) -> Option<f64> {
    if a == DVec3::ZERO || b == DVec3::ZERO {
        return None;
    }
    Some(a.cross(b).length().atan2(a.dot(b)).to_degrees())
}

/// A third of each triangle's area for each of its points.
fn areas(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| points[i as usize]);
        let share = (b - a).cross(c - a).length() / 6.0;
        for &point in triangle {
            areas[point as usize] += share;
        }
    }
    areas
}

/// What is told of many errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// The greatest.
    pub maximum: f64,
    /// The mean over the surface's area.
    pub mean: f64,
    /// The root of the mean square over the surface's area.
    pub rms: f64,
    /// Points with nothing to compare.
    pub skipped: usize,
}

impl Summary {
    fn new(errors: &[Option<f64>], areas: &[f64]) -> Summary {
        let flat = areas.iter().sum::<f64>() == 0.0;
        let known = || {
            let known = errors.iter().zip(areas);
            // Surfaces without any area still have points.
            known.filter_map(|(&error, &area)| Some((error?, if flat { 1.0 } else { area })))
        };
        let area: f64 = known().map(|(_, area)| area).sum();
        let mean = |f: fn(f64) -> f64| {
            let sum: f64 = known().map(|(error, area)| f(error) * area).sum();
            sum / area.max(f64::MIN_POSITIVE)
        };
        Summary {
            maximum: known().map(|(error, _)| error).fold(0.0, f64::max),
            mean: mean(|error| error),
            rms: mean(|error| error * error).sqrt(),
            skipped: errors.iter().filter(|error| error.is_none()).count(),
        }
    }

    /// As JSON.
    pub fn json(&self) -> Value {
        json!({
            "maximum": self.maximum,
            "mean": self.mean,
            "rms": self.rms,
            "skipped_points": self.skipped,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_over_area_and_leave_out_what_is_skipped() {
        let summary = Summary::new(&[Some(1.0), Some(3.0), None], &[3.0, 1.0, 7.0]);
        assert_eq!((summary.maximum, summary.mean), (3.0, 1.5));
        assert_eq!((summary.rms, summary.skipped), (3.0f64.sqrt(), 1));
        let nothing = Summary::new(&[None], &[1.0]);
        assert_eq!(
            (nothing.maximum, nothing.mean, nothing.rms),
            (0.0, 0.0, 0.0)
        );
    }

    #[test]
    fn a_surface_without_area_counts_its_points() {
        assert_eq!(Summary::new(&[Some(1.0), Some(3.0)], &[0.0, 0.0]).mean, 2.0);
    }

    #[test]
    fn small_angles_are_told_apart_and_no_direction_has_none() {
        let tilted = DVec3::new(1e-9, 0.0, 1.0);
        let degrees = angle(DVec3::Z, tilted).expect("two directions");
        assert!((degrees - 1e-9f64.to_degrees()).abs() < 1e-15);
        assert_eq!(angle(DVec3::Z, -DVec3::Z), Some(180.0));
        assert_eq!(angle(DVec3::Z, DVec3::ZERO), None);
    }
}
