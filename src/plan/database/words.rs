//! Entries as words, and back. What is read may be anything: nothing is believed before [`check`] has seen it.
//!
//! Weights are written as the `f32` that shaders read, so an entry that comes back packs to the same bytes.

use smallvec::SmallVec;

use crate::abi;
use crate::plan::builder::Plan;
use crate::plan::configuration::Configuration;
use crate::plan::database::check;
use crate::plan::database::entry::{Entry, Key, Kind};
use crate::plan::edge::EdgePlan;
use crate::plan::lists::Lists;
use crate::plan::options::PlanOptions;
use crate::plan::stencil_rows::StencilRows;
use crate::plan::stencils::Stencils;
use crate::plan::strip::{Crease, Stretch, Strip};
use crate::plan::tree::Node;
use crate::plan::vertex::{Side, VertexPlan};

/// Instead of a number: there is none.
const NONE: u32 = u32::MAX;

/// The words of a key.
pub fn of_key(key: &Key) -> Vec<u32> {
    let PlanOptions {
        max_level,
        direct_creases,
    } = key.options;
    let mut words = vec![key.kind as u32, max_level, u32::from(direct_creases)];
    words.extend_from_slice(key.configuration.words());
    words
}

/// The key that words tell; None where they tell none.
pub fn key(words: &[u32]) -> Option<Key> {
    let [kind, max_level, direct_creases, configuration @ ..] = words else {
        return None;
    };
    let options = PlanOptions {
        max_level: *max_level,
        direct_creases: match direct_creases {
            0 => false,
            1 => true,
            _ => return None,
        },
    };
    Some(Key {
        kind: *Kind::ALL.get(*kind as usize)?,
        options: options.check().ok()?,
        configuration: Configuration::from_words(configuration)?,
    })
}

/// The words of an entry.
pub fn of_entry(entry: &Entry) -> Vec<u32> {
    let plan = entry.plan();
    let mut words = vec![plan.ring_size as u32, plan.max_level];
    words.push(plan.nodes.len() as u32);
    plan.nodes
        .iter()
        .for_each(|node| put_node(&mut words, node));
    put_rows(&mut words, &plan.packed_stencils());
    for tangents in &plan.nearby {
        words.push(u32::from(tangents.is_some()));
        for row in tangents.iter().flatten() {
            put_weights(&mut words, row);
        }
    }
    for strip in &plan.strips {
        let count = strip.as_ref().map(|strip| strip.stretches().count() as u32);
        words.push(count.unwrap_or(NONE));
        for stretch in strip.iter().flat_map(Strip::stretches) {
            put_stretch(&mut words, stretch);
        }
    }
    match entry {
        Entry::Inside(_) => {}
        Entry::Edge(EdgePlan { sides, .. }) => put_list(&mut words, sides),
        Entry::Vertex(VertexPlan { sides, planes, .. }) => {
            words.push(*planes as u32);
            let sides = sides
                .iter()
                .map(|side| side.pair.map_or(NONE >> 1, |pair| pair) << 1 | u32::from(side.spare));
            put_list(&mut words, &sides.collect::<Vec<u32>>());
        }
    }
    words
}

fn put_list(words: &mut Vec<u32>, list: &[u32]) {
    words.push(list.len() as u32);
    words.extend_from_slice(list);
}

fn put_rows(words: &mut Vec<u32>, rows: &StencilRows) {
    words.push(rows.rows.len() as u32);
    words.extend(rows.rows.as_flattened());
    for lists in [&rows.sets, &rows.patterns] {
        put_list(words, lists.ends());
        words.extend(&lists.words);
    }
}

fn put_weights(words: &mut Vec<u32>, weights: &[f64]) {
    words.extend(weights.iter().map(|&weight| (weight as f32).to_bits()));
}

fn put_node(words: &mut Vec<u32>, node: &Node) {
    let number = |base: &Option<u32>| base.unwrap_or(NONE);
    match node {
        Node::Internal { children } => words.extend([abi::NODE_INTERNAL, *children]),
        Node::Regular {
            points,
            mirrored,
            base,
        } => {
            let kind = if *mirrored {
                abi::NODE_BOUNDARY
            } else {
                abi::NODE_REGULAR
            };
            words.extend([kind, number(base)]);
            words.extend(points);
        }
        Node::Crease {
            points,
            edge,
            sharpness,
            base,
        } => {
            words.extend([abi::NODE_CREASE, number(base), *edge, sharpness.to_bits()]);
            words.extend(points);
        }
        Node::Terminal {
            corner,
            levels,
            base,
        } => {
            words.extend([
                abi::NODE_TERMINAL,
                number(base),
                *corner,
                levels.len() as u32,
            ]);
            words.extend(levels.iter().flatten());
        }
        Node::Curve {
            points,
            edge,
            sharpness,
            base,
        } => {
            words.extend([abi::NODE_CURVE, number(base), *edge, sharpness.to_bits()]);
            put_list(words, points);
        }
        Node::Extraordinary { corner } => words.extend([abi::NODE_EXTRAORDINARY, *corner]),
    }
}

fn put_stretch(words: &mut Vec<u32>, stretch: &Stretch) {
    let (kind, sharpness) = match stretch.crease {
        Crease::None => (0, 0.0),
        Crease::Along(sharpness) => (1, sharpness),
        Crease::Across(end, sharpness) => (2 + end, sharpness),
    };
    words.extend([
        stretch.depth,
        stretch.at,
        stretch.base,
        kind,
        sharpness.to_bits(),
        u32::from(stretch.points.is_some()),
    ]);
    words.extend(stretch.points.iter().flatten().flatten());
}

/// Reads words from the first to the last; None beyond.
struct Words<'a>(&'a [u32]);

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<u32> {
        let (&first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(first)
    }

    fn take(&mut self, count: usize) -> Option<&'a [u32]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    /// A count of what takes a word each at least, so that no more memory is asked for than there are words.
    fn count(&mut self) -> Option<usize> {
        let count = self.next()? as usize;
        (count <= self.0.len()).then_some(count)
    }

    fn list(&mut self) -> Option<Vec<u32>> {
        let count = self.count()?;
        self.take(count).map(<[u32]>::to_vec)
    }

    fn optional(&mut self) -> Option<Option<u32>> {
        let word = self.next()?;
        Some((word != NONE).then_some(word))
    }

    fn flag(&mut self) -> Option<bool> {
        match self.next()? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }

    fn float(&mut self) -> Option<f32> {
        self.next().map(f32::from_bits)
    }

    fn array<const N: usize>(&mut self) -> Option<[u32; N]> {
        self.take(N)?.try_into().ok()
    }

    fn weights(&mut self, ring: usize) -> Option<Vec<f64>> {
        let words = self.take(ring)?.iter();
        Some(words.map(|&word| f32::from_bits(word).into()).collect())
    }

    fn rows(&mut self, ring: usize) -> Option<StencilRows> {
        let count = self.count()?;
        let (rows, _) = self.take(count.checked_mul(2)?)?.as_chunks::<2>();
        let rows = rows.to_vec();
        let (sets, patterns) = (self.lists()?, self.lists()?);
        StencilRows::checked(ring, rows, sets, patterns)
    }

    fn lists(&mut self) -> Option<Lists> {
        let count = self.count()?;
        let ends = self.take(count)?;
        let words = self.take(ends.last().map_or(0, |&end| end as usize))?;
        Lists::cut(words, ends)
    }

    fn node(&mut self) -> Option<Node> {
        Some(match self.next()? {
            abi::NODE_INTERNAL => Node::Internal {
                children: self.next()?,
            },
            kind @ (abi::NODE_REGULAR | abi::NODE_BOUNDARY) => Node::Regular {
                base: self.optional()?,
                points: self.array()?,
                mirrored: kind == abi::NODE_BOUNDARY,
            },
            abi::NODE_CREASE => Node::Crease {
                base: self.optional()?,
                edge: self.next()?,
                sharpness: self.float()?,
                points: self.array()?,
            },
            abi::NODE_TERMINAL => {
                let (base, corner, levels) = (self.optional()?, self.next()?, self.count()?);
                let levels: Option<Vec<[u32; 25]>> = (0..levels).map(|_| self.array()).collect();
                Node::Terminal {
                    corner,
                    levels: levels?,
                    base,
                }
            }
            abi::NODE_CURVE => Node::Curve {
                base: self.optional()?,
                edge: self.next()?,
                sharpness: self.float()?,
                points: self.list()?,
            },
            abi::NODE_EXTRAORDINARY => Node::Extraordinary {
                corner: self.next()?,
            },
            _ => return None,
        })
    }

    fn stretch(&mut self) -> Option<Stretch> {
        let [depth, at, base, kind] = self.array()?;
        let sharpness = self.float()?;
        let crease = match kind {
            0 => Crease::None,
            1 => Crease::Along(sharpness),
            2 | 3 => Crease::Across(kind - 2, sharpness),
            _ => return None,
        };
        let points = match self.flag()? {
            true => Some([self.array()?, self.array()?, self.array()?]),
            false => None,
        };
        Some(Stretch {
            depth,
            at,
            points,
            crease,
            base,
        })
    }

    fn strip(&mut self) -> Option<Option<Strip>> {
        let Some(count) = self.optional()? else {
            return Some(None);
        };
        if count as usize > self.0.len() {
            return None;
        }
        let stretches: Option<Vec<Stretch>> = (0..count).map(|_| self.stretch()).collect();
        Some(Some(Strip::from_stretches(stretches?)))
    }

    fn plan(&mut self) -> Option<Plan> {
        let [ring_size, max_level] = self.array()?;
        let ring = ring_size as usize;
        let nodes = self.count()?;
        let nodes: Option<Vec<Node>> = (0..nodes).map(|_| self.node()).collect();
        let stencils = Stencils::of(ring, self.rows(ring)?);
        let mut nearby: [Option<[Vec<f64>; 2]>; 4] = Default::default();
        for tangents in &mut nearby {
            if self.flag()? {
                *tangents = Some([self.weights(ring)?, self.weights(ring)?]);
            }
        }
        let mut strips: [Option<Strip>; 4] = Default::default();
        for strip in &mut strips {
            *strip = self.strip()?;
        }
        Some(Plan {
            ring_size: ring,
            max_level,
            nodes: nodes?,
            stencils,
            nearby,
            strips,
        })
    }
}

/// The entry that words tell of a key; None where they tell none, or one that is not sound.
pub fn entry(words: &[u32], key: &Key) -> Option<Entry> {
    let mut words = Words(words);
    let plan = words.plan()?;
    let entry = match key.kind {
        Kind::Inside => Entry::Inside(plan),
        Kind::Edge | Kind::Spoke => Entry::Edge(EdgePlan {
            plan,
            sides: words.list()?,
        }),
        Kind::Vertex | Kind::Centre => {
            let planes = words.next()? as usize;
            let sides: SmallVec<[u32; 8]> = words.list()?.into();
            let side = |word: &u32| Side {
                pair: (word >> 1 != NONE >> 1).then_some(word >> 1),
                spare: word & 1 != 0,
            };
            Entry::Vertex(VertexPlan {
                plan,
                sides: sides.iter().map(side).collect(),
                planes,
            })
        }
    };
    (words.0.is_empty() && check::is_sound(key, &entry)).then_some(entry)
}
