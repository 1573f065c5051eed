//! The edges that creases name, found again by their ends.

/// The edges that creases name, each once, by their ends. Most edges have none, and are told apart from the others by a bit of their lower end.
pub(super) struct CreasedEdges {
    /// The lower end and the higher one, sorted.
    edges: Vec<[u32; 2]>,
    /// The number of the last crease that names each.
    last: Vec<u32>,
    /// A bit for each vertex: whether any edge has it as its lower end.
    lower: Vec<u64>,
}

impl CreasedEdges {
    /// Of creases by their ends, which may be no edge, or no vertices.
    pub fn new(vertex_count: usize, creases: impl Iterator<Item = [u32; 2]>) -> CreasedEdges {
        let numbered = (0..).zip(creases);
        let mut named: Vec<([u32; 2], u32)> = numbered
            .map(|(number, ends)| (ordered(ends), number))
            .collect();
        named.sort_unstable();
        // Of several creases on an edge the last one counts.
        named.dedup_by(|next, kept| {
            let alike = next.0 == kept.0;
            if alike {
                kept.1 = next.1;
            }
            alike
        });
        let mut lower = Vec::new();
        if !named.is_empty() {
            lower.resize(vertex_count.div_ceil(64), 0);
        }
        for &([low, _], _) in &named {
            if let Some(word) = lower.get_mut(low as usize / 64) {
                *word |= 1 << (low % 64);
            }
        }
        let (edges, last) = named.into_iter().unzip();
        CreasedEdges { edges, last, lower }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.edges.len()
    }

    /// The number of the edge between two vertices, in either order; None where no crease names it.
    pub fn number(&self, ends: [u32; 2]) -> Option<usize> {
        let ends = ordered(ends);
        let word = self.lower.get(ends[0] as usize / 64)?;
        if word >> (ends[0] % 64) & 1 == 0 {
            return None;
        }
        self.edges.binary_search(&ends).ok()
    }

    /// The last crease that names the edge between two vertices.
    pub fn crease(&self, ends: [u32; 2]) -> Option<usize> {
        self.number(ends).map(|edge| self.last[edge] as usize)
    }
}

/// The two vertices of an edge, the lesser first.
fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}
