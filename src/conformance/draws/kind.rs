//! Direct, indexed, indirect, several at once: the calls that draw.

/// The kinds of draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Draw,
    Indexed,
    Indirect,
    IndexedIndirect,
    /// Of several ranges in a call (`VK_EXT_multi_draw`).
    Multi,
    MultiIndexed,
    /// Indirect, with their number in a buffer.
    Counted,
    CountedIndexed,
}

impl Kind {
    pub const ALL: [Kind; 8] = [
        Kind::Draw,
        Kind::Indexed,
        Kind::Indirect,
        Kind::IndexedIndirect,
        Kind::Multi,
        Kind::MultiIndexed,
        Kind::Counted,
        Kind::CountedIndexed,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Kind::Draw => "draw",
            Kind::Indexed => "indexed",
            Kind::Indirect => "indirect",
            Kind::IndexedIndirect => "indexed_indirect",
            Kind::Multi => "multi",
            Kind::MultiIndexed => "multi_indexed",
            Kind::Counted => "counted",
            Kind::CountedIndexed => "counted_indexed",
        }
    }

    pub fn has_indices(self) -> bool {
        matches!(
            self,
            Kind::Indexed | Kind::IndexedIndirect | Kind::MultiIndexed | Kind::CountedIndexed
        )
    }

    pub fn is_indirect(self) -> bool {
        matches!(self, Kind::Indirect | Kind::IndexedIndirect) || self.is_counted()
    }

    pub fn is_multi(self) -> bool {
        matches!(self, Kind::Multi | Kind::MultiIndexed)
    }

    pub fn is_counted(self) -> bool {
        matches!(self, Kind::Counted | Kind::CountedIndexed)
    }
}
