//! Who decides about patches for `render` and `bench`, and by what.

use hullform::gpu::{Backend, Decides, Decision, Outcome, Samples, Slots};
use hullform::method::Outline;
use hullform::{Error, Result};
use serde_json::{Value, json};

use crate::adaptive::{Adaptive, Seen};
use crate::options::{Cull, Culling};

/// What somebody wants decided about patches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted {
    /// Levels.
    pub adaptive: Option<Adaptive>,
    /// What is left out.
    pub culling: Culling,
}

impl Wanted {
    /// Who decides for levels up to `level`: the device, where there is something to decide and it can. Without it levels go by depth tags, and patches are
    /// drawn as they are; so they do of methods that refine as deep as a frame needs (`is_dynamic`), which the host alone decides for each place, but where patches are left out.
    ///
    /// # Errors
    /// [`Error::Option`] for patches that are to be left out, which nobody does then.
    pub fn decides(
        self,
        (backend, is_dynamic): (Backend, bool),
        slots: Slots,
        level: f32,
    ) -> Result<Decides> {
        let whole = level <= backend.greatest_level();
        let able = backend == Backend::Tessellator && slots == Slots::Counter && whole;
        if !able && self.culling.needs_decisions() {
            return Err(Error::Option {
                option: "--cull",
                problem: "patches are left out by the device, which decides for the tessellator alone, with slots by counters, and up to level 64".into(),
                remedy: "leave out --backend, --slots and levels above 64, or frustum and small".into(),
            });
        }
        let by_place = is_dynamic && !self.culling.needs_decisions();
        Ok(match able && !by_place && self.is_anything() {
            true => Decides::Device,
            false => Decides::Host,
        })
    }

    /// Whether there is anything to decide.
    pub fn is_anything(self) -> bool {
        self.adaptive.is_some() || self.culling != Culling::default()
    }

    /// The same in a picture whose pixels are drawn as squares of so many.
    pub fn scaled(self, factor: f32) -> Wanted {
        let scaled = |adaptive: Adaptive| adaptive.scaled(factor);
        Wanted {
            adaptive: self.adaptive.map(scaled),
            ..self
        }
    }

    /// What the device decides by, as seen from somewhere, of an outline with control vertices in local units; `a_pixel` are the samples there.
    ///
    /// # Errors
    /// As [`Outline::limits`].
    pub fn decision(
        self,
        outline: &Outline,
        vertices: &[glam::Vec3],
        seen: Seen,
        a_pixel: u32,
    ) -> Result<Decision> {
        let size = seen.size;
        let metric = self
            .adaptive
            .map(|adaptive| adaptive.metric(outline, vertices, seen));
        Ok(Decision {
            metric: metric.transpose()?.unwrap_or_default(),
            frustum: self.culling.frustum,
            back: self.culling.triangles == Cull::Back,
            small: self.culling.small.then_some(Samples { a_pixel, size }),
            seen_from: None,
        })
    }
}

/// What was decided, for statistics.
pub fn as_json(outcome: &Outcome) -> Value {
    json!({
        "patches_drawn": outcome.drawn,
        "patches_culled": {
            "frustum": outcome.frustum,
            "back": outcome.back,
            "small": outcome.small,
        },
        "vertices": outcome.vertices,
        "triangles": outcome.triangles,
        "greatest_segments": outcome.segments,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_device_decides_where_there_is_something_and_it_can() {
        let culling: Culling = "frustum".parse().expect("a name");
        let wanted = Wanted {
            adaptive: None,
            culling,
        };
        let decides =
            |wanted: Wanted, backend, slots| wanted.decides((backend, false), slots, 8.0).ok();
        let (all, some) = (Backend::Tessellator, Backend::Pattern);
        let nothing = Wanted::default();
        assert_eq!(decides(nothing, all, Slots::Counter), Some(Decides::Host));
        assert_eq!(decides(wanted, all, Slots::Counter), Some(Decides::Device));
        assert_eq!(decides(wanted, some, Slots::Counter), None);
        assert_eq!(decides(wanted, all, Slots::Host), None);
        let tagged = Wanted {
            adaptive: Some(Adaptive::Screen(8.0)),
            culling: Culling::default(),
        };
        assert_eq!(decides(tagged, some, Slots::Counter), Some(Decides::Host));
        assert_eq!(decides(tagged, all, Slots::Counter), Some(Decides::Device));
        let above = |wanted: Wanted| wanted.decides((all, false), Slots::Counter, 65.0).ok();
        assert_eq!((above(tagged), above(wanted)), (Some(Decides::Host), None));
        let dynamic = |wanted: Wanted| wanted.decides((all, true), Slots::Counter, 8.0).ok();
        assert_eq!(dynamic(tagged), Some(Decides::Host));
        assert_eq!(dynamic(wanted), Some(Decides::Device));
    }
}
