//! Which tess coordinates fall into a cell, and from which level on (Brainerd et al. 2016, section 4.2).

/// The coordinates in one direction that the walk sends into a cell: an interval, with or without its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    low: f64,
    high: f64,
    with_low: bool,
    with_high: bool,
}

impl Span {
    /// All of 0..=1.
    pub const WHOLE: Span = Span {
        low: 0.0,
        high: 1.0,
        with_low: true,
        with_high: true,
    };

    /// The two halves; `upper` tells which takes the middle.
    pub fn split(self, upper: bool) -> [Span; 2] {
        let middle = 0.5 * (self.low + self.high);
        [
            Span {
                high: middle,
                with_high: !upper,
                ..self
            },
            Span {
                low: middle,
                with_low: upper,
                ..self
            },
        ]
    }

    /// Which half takes the middle in an internal node: the one nearer to the face's middle; the upper one of the whole.
    pub fn interior_half_is_upper(self) -> bool {
        self.low < 0.5
    }

    /// Whether a coordinate strictly inside the face may fall into it when no tess factor exceeds 2^level: such coordinates keep
    /// 2^-level away from the ends.
    fn has_inner(self, level: u32) -> bool {
        let edge = 0.5f64.powi(level as i32);
        let (low, high) = (self.low.max(edge), self.high.min(1.0 - edge));
        let with_low = self.with_low || low > self.low;
        let with_high = self.with_high || high < self.high;
        low < high || (low == high && with_low && with_high)
    }

    /// The lowest level, of 1..=deepest, at which a tess coordinate inside may fall into it.
    pub fn required_level(self, deepest: u32) -> u32 {
        let needed = |&level: &u32| self.has_inner(level);
        (1..deepest).find(needed).unwrap_or(deepest)
    }
}

/// The lowest level, of 1..=deepest, at which a tess coordinate inside the face may fall into the cell `u` x `v`.
pub fn required_level(u: Span, v: Span, deepest: u32) -> u32 {
    u.required_level(deepest).max(v.required_level(deepest))
}
