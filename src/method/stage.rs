//! When patches are drawn of a method that refines as deep as a frame needs, and which points that takes.

use crate::abi;

/// No irregularity.
pub(super) const NOWHERE: u32 = u32::MAX;
/// One that is always refined further.
pub(super) const ALWAYS: u32 = u32::MAX - 1;

/// When a patch is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stage {
    /// The irregularity by whose depth it goes; `NOWHERE` of what is always drawn.
    pub irregularity: u32,
    /// From which depth on, and up to which. The first is how often the mesh is refined for it.
    pub depths: [u32; 2],
    /// Beyond each edge the irregularity of a face that is drawn as two patches there if it is refined further; or `NOWHERE`, or `ALWAYS`.
    pub beside: [u32; 4],
}

/// Between which depths the rows of a step are needed, and where those of each irregularity end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Span {
    /// The step, by its number.
    pub step: usize,
    /// As a stage has them.
    pub depths: [u32; 2],
    /// By irregularity, counted from the step's first row.
    pub ends: Vec<u32>,
}

impl Span {
    /// The parts of a step that are needed at depths of irregularities: what follows one another is one.
    pub fn needed(&self, step: &abi::PointStep, depths: &[u32]) -> Vec<abi::PointStep> {
        let [from, to] = self.depths;
        let mut parts: Vec<abi::PointStep> = Vec::new();
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        for ((start, &end), depth) in starts.zip(&self.ends).zip(depths) {
            if !(from..=to).contains(depth) || start == end {
                continue;
            }
            match parts.last_mut() {
                Some(last) if last.first_row + last.count == step.first_row + start => {
                    last.count += end - start;
                }
                _ => parts.push(abi::PointStep {
                    first_row: step.first_row + start,
                    first_point: step.first_point + start,
                    count: end - start,
                    ..*step
                }),
            }
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn needed_rows_follow_one_another() {
        let step = abi::PointStep {
            kind: abi::POINTS_REFINE,
            first_row: 100,
            first_point: 7,
            count: 10,
        };
        let span = Span {
            step: 0,
            depths: [3, u32::MAX],
            ends: vec![2, 5, 5, 6, 10],
        };
        let parts = |depths: &[u32]| -> Vec<[u32; 3]> {
            let parts = span.needed(&step, depths);
            let three = |part: &abi::PointStep| [part.first_row, part.first_point, part.count];
            parts.iter().map(three).collect()
        };
        assert_eq!(parts(&[3, 6, 1, 3, 3]), [[100, 7, 10]]);
        assert_eq!(parts(&[1, 3, 3, 2, 4]), [[102, 9, 3], [106, 13, 4]]);
        assert!(parts(&[2; 5]).is_empty());
    }
}
