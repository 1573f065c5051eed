//! What a pass of patches with plans has beside its tables, and how these follow it.

use crate::method::quadtree::border::Borders;
use crate::method::quadtree::irregular::Record;
use crate::method::quadtree::store::Store;
use crate::method::quadtree::view::sums;
use crate::method::{Pass, PassChange, Table};
use crate::plan::database::Entry;

/// What a pass of patches with plans has beside its tables.
#[derive(Default)]
pub struct Planned {
    /// Its plans.
    pub store: Store,
    /// Its borders.
    pub borders: Borders,
    /// By slot.
    pub records: Vec<Record>,
    /// The words of quadtrees that are plans of insides; only when all faces were planned at once.
    pub inside_bytes: usize,
}

impl Planned {
    /// How many plans there are of insides, edges, and vertices.
    pub fn counts(&self) -> [usize; 3] {
        let mut counts = [0; 3];
        for entry in self.store.entries() {
            counts[match entry {
                Entry::Inside(_) => 0,
                Entry::Edge(_) => 1,
                Entry::Vertex(_) => 2,
            }] += 1;
        }
        counts
    }

    /// Brings what a pass knows of its slots up to its borders.
    pub fn count(&mut self, pass: &mut Pass) {
        let Borders {
            records,
            uses,
            ends,
            ..
        } = &self.borders;
        let known = pass.scratch_points.len();
        for border in &records[known..] {
            let (points, products) = sums(border, uses, ends);
            pass.scratch_points.push(points);
            pass.scratch_products.push(products);
        }
        let packed = &mut self.store.packed;
        let products = packed.headers.iter().map(|header| {
            let stencils = header.counts.iter().copied().max().unwrap_or(0);
            u64::from(header.ring_size) * u64::from(stencils)
        });
        packed.rows.hold(products.max().unwrap_or(0));
    }

    /// Brings a pass' tables up to its plans and borders.
    pub fn grow(&self, pass: &mut Pass, change: &mut PassChange) {
        let (packed, borders) = (&self.store.packed, &self.borders);
        let rows = packed.rows.view();
        let tables = [
            Table::grown(&packed.nodes),
            Table::grown(bytemuck::cast_slice::<u32, [u32; 2]>(&packed.points)),
            Table::grown(rows.rows),
            Table::grown(rows.sets),
            Table::grown(rows.patterns),
            Table::grown(&borders.uses),
            Table::grown(&borders.ends),
            Table::grown(&borders.records),
        ];
        for (number, (words, stride)) in tables.into_iter().enumerate() {
            if pass.tables.len() == number {
                pass.tables.push(Table::default());
            }
            change.own(number, pass.tables[number].grow(words, stride));
        }
    }

    /// A pass' tables, of what is planned no more: large ones are not there twice.
    pub fn into_tables(self) -> Vec<Table> {
        let Planned { store, borders, .. } = self;
        let packed = store.into_packed();
        let [rows, sets, patterns] = packed.rows.into_words();
        vec![
            Table::of(&packed.nodes),
            Table::of_words(packed.points, 2),
            Table::of_words(rows, 2),
            Table::of_words(sets, 1),
            Table::of_words(patterns, 1),
            Table::of(&borders.uses),
            Table::of(&borders.ends),
            Table::of(&borders.records),
        ]
    }
}
