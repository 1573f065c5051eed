//! Deformations of control vertices over time: plans stay as they are.

use glam::{DVec2, DVec3};

use crate::eye::Sphere;

/// What moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Nothing.
    #[default]
    None,
    /// Along y, around x.
    Bend,
    /// Around y.
    Twist,
    /// Waves along the diagonal.
    Wobble,
}

impl Kind {
    /// All of them.
    pub const ALL: [Kind; 4] = [Kind::None, Kind::Bend, Kind::Twist, Kind::Wobble];

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Kind::None => "none",
            Kind::Bend => "bend",
            Kind::Twist => "twist",
            Kind::Wobble => "wobble",
        }
    }
}

/// A deformation with its clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deform {
    /// What moves.
    pub kind: Kind,
    /// How far, from 0 to 1.
    pub amount: f64,
    /// Seconds into a turn of [`TURN`](Deform::TURN).
    pub time: f64,
    /// Whether time goes on.
    pub playing: bool,
}

impl Default for Deform {
    fn default() -> Deform {
        Deform {
            kind: Kind::None,
            amount: 0.5,
            time: 1.0,
            playing: false,
        }
    }
}

impl Deform {
    /// Seconds until everything is again as it was.
    pub const TURN: f64 = 4.0;

    /// Whether anything moves.
    pub fn is_playing(&self) -> bool {
        self.playing && self.kind != Kind::None
    }

    /// Lets time go on, or stops it. What is asked to move without a kind bends.
    pub fn play(&mut self) {
        self.playing = !self.is_playing();
        if self.kind == Kind::None {
            self.kind = Kind::Bend;
        }
    }

    /// Lets so many seconds pass.
    pub fn pass(&mut self, seconds: f64) {
        if self.is_playing() {
            self.time = (self.time + seconds.clamp(0.0, 0.25)).rem_euclid(Deform::TURN);
        }
    }

    /// Where points are now, of a model in a sphere.
    pub fn points(&self, points: &[DVec3], all: Sphere) -> Vec<DVec3> {
        let turn = std::f64::consts::TAU * self.time / Deform::TURN;
        let swing = self.amount * turn.sin();
        let moved = |&point: &DVec3| {
            let at = (point - all.centre) / all.radius;
            all.centre + all.radius * moved(self.kind, at, swing, self.amount, turn)
        };
        match self.kind {
            Kind::None => points.to_vec(),
            _ => points.iter().map(moved).collect(),
        }
    }
}

/// Where a point of the unit sphere goes.
fn moved(kind: Kind, at: DVec3, swing: f64, amount: f64, turn: f64) -> DVec3 {
    match kind {
        Kind::None => at,
        Kind::Twist => {
            let turned = DVec2::from_angle(1.5 * swing * at.y).rotate(DVec2::new(at.x, at.z));
            DVec3::new(turned.x, at.y, turned.y)
        }
        // Along an arc whose length is that of the y axis; straight where there is no bend.
        Kind::Bend => {
            let curvature = 1.2 * swing;
            if curvature.abs() < 1e-6 {
                return at;
            }
            let (sin, cos) = (curvature * at.y).sin_cos();
            let reach = 1.0 / curvature - at.z;
            DVec3::new(at.x, reach * sin, 1.0 / curvature - reach * cos)
        }
        Kind::Wobble => {
            let wave = |along: f64| 0.08 * amount * (5.0 * along + turn).sin();
            at + DVec3::new(wave(at.y), wave(at.z), wave(at.x))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_comes_back_to_where_it_began_and_nothing_is_torn() {
        let points: Vec<DVec3> = (0..50).map(|i| DVec3::splat(f64::from(i) * 0.02)).collect();
        let all = Sphere::around(points.iter().copied());
        for kind in Kind::ALL {
            let mut deform = Deform {
                kind,
                amount: 1.0,
                time: 0.7,
                playing: true,
            };
            let first = deform.points(&points, all);
            let near = first.windows(2).all(|pair| pair[0].distance(pair[1]) < 0.2);
            assert!(near, "{kind:?}");
            for _ in 0..16 {
                deform.pass(Deform::TURN / 16.0);
            }
            let back = deform.points(&points, all);
            let far = first.iter().zip(&back).map(|(a, b)| a.distance(*b));
            assert!(far.fold(0.0, f64::max) < 1e-9, "{kind:?}");
            assert_eq!(kind == Kind::None, first == points);
        }
    }
}
