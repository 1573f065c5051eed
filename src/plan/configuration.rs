//! The configuration of a face: all that shapes its limit but the positions (Brainerd et al. 2016, section 4.3).
//!
//! Faces of equal configuration share a plan. A configuration lists the faces of the 1-ring in the order of a walk around the face's
//! corners, each with its vertices numbered as they are first met; the sharpness of the corners; and that of the edges at the corners.
//! Nothing farther out has a say (see `subdivision::refine`), except that under Chaikin's rule the next sharpness at an edge's far end
//! does: it is part of what an edge brings along.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::error::{Error, Misuse, Result};
use crate::mesh::topology::{Hub, Hubs, Topology};
use crate::mesh::{CreaseMethod, SchemeOptions, TriangleSubdivision};

/// What a plan depends on. Equal configurations are equal words; the words hold the whole local mesh, so no two differ by accident.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Configuration {
    words: Vec<u32>,
}

/// What a hub is, in the words that tell of it: its number twice, so that it is no edge; this; the number of the first vertex that is given of it, and how many are.
pub(super) const HUB_VERTEX: u32 = 0;
/// The same of a face.
pub(super) const HUB_FACE: u32 = 1;
/// The same of a face of which only the mean of its vertices is given.
const MEAN: u32 = 2;
/// What is given stands behind so many vertices: such a ring is a long one, whose first vertices alone are handed on by the vertex shader.
pub(super) const GIVEN: usize = 1 + crate::abi::CONTROL_INVOCATIONS as usize;
/// How many words tell of an edge or a hub.
const RECORD: usize = 5;
/// So much may be given of a hub.
const MOST_GIVEN: u32 = 32;

/// Whether a word is a sharpness.
fn is_float(word: u32) -> bool {
    f32::from_bits(word) >= 0.0
}

impl Configuration {
    /// That of a ring, in its words.
    pub(super) fn of(words: Vec<u32>) -> Configuration {
        Configuration { words }
    }

    /// The local mesh that the words tell: face 0 is the face itself, vertices are numbered as in [`Ring::vertices`](super::Ring::vertices).
    pub fn topology(&self) -> Topology {
        let mut words = self.words.iter().copied();
        let mut word = || {
            words
                .next()
                .expect("a configuration is written as it is read")
        };
        let flags = word();
        let options = SchemeOptions {
            creasing: if flags & 1 != 0 {
                CreaseMethod::Chaikin
            } else {
                CreaseMethod::Uniform
            },
            triangles: if flags & 2 != 0 {
                TriangleSubdivision::Smooth
            } else {
                TriangleSubdivision::CatmullClark
            },
            ..SchemeOptions::default()
        };
        let faces: Vec<SmallVec<[u32; 4]>> = (0..word())
            .map(|_| (0..word()).map(|_| word()).collect())
            .collect();
        let corners = word() as usize;
        let mut sharpness = vec![0.0; self.vertex_count() as usize];
        for sharpness in &mut sharpness[..corners] {
            *sharpness = f32::from_bits(word());
        }
        let rest: Vec<u32> = words.collect();
        let records = || rest.chunks_exact(RECORD);
        let edges = records().filter(|record| record[0] != record[1]);
        let edges: FxHashMap<[u32; 2], [f32; 3]> = edges
            .map(|edge| {
                (
                    [edge[0], edge[1]],
                    [edge[2], edge[3], edge[4]].map(f32::from_bits),
                )
            })
            .collect();
        let hubs = |kind: u32| -> Vec<Hub> {
            let own = records().filter(|record| record[0] == record[1] && record[2] == kind);
            own.map(|record| Hub {
                at: record[0],
                first: record[3],
                count: record[4],
            })
            .collect()
        };
        let hubs = Hubs::new(hubs(HUB_VERTEX), hubs(HUB_FACE)).with_means(hubs(MEAN));
        let topology = Topology::connect(
            faces.iter().map(|face| &face[..]),
            sharpness,
            options,
            |a, b| {
                let [sharpness, near, far] = edges
                    .get(&[a.min(b), a.max(b)])
                    .copied()
                    .unwrap_or_default();
                (sharpness, if a < b { [near, far] } else { [far, near] })
            },
        );
        topology.with_hubs(hubs)
    }

    /// Around how many corners of face 0 it has all faces: all of its corners in the ring of a face, 2 in that of an edge, 1 in that of a vertex.
    fn corners(&self) -> u32 {
        let faces = self.words[1];
        let end = (0..faces).fold(2, |at, _| at + 1 + self.words[at] as usize);
        self.words[end]
    }

    /// Refuses to plan for what lies around more corners than the configuration tells of.
    ///
    /// # Errors
    /// [`Misuse::Ring`].
    pub(super) fn check_corners(&self, needed: u32) -> Result<()> {
        match self.corners() {
            given if given < needed => Err(Error::Misuse(Misuse::Ring { needed, given })),
            _ => Ok(()),
        }
    }

    /// The number of corners of face 0.
    pub(super) fn arity(&self) -> u32 {
        self.words[2]
    }

    /// The configuration that [`words`](Self::words) gave, from where they were stored; None where they tell none.
    pub(super) fn from_words(words: &[u32]) -> Option<Configuration> {
        let ([flags, faces], mut rest) = words.split_first_chunk()?;
        let flags = *flags;
        let mut vertices = 0;
        for _ in 0..*faces {
            let (&arity, behind) = rest.split_first()?;
            let (face, behind) = behind.split_at_checked(arity as usize)?;
            for &vertex in face {
                if vertex > vertices {
                    return None;
                }
                vertices = vertices.max(vertex + 1);
            }
            rest = behind;
            if arity < 3 {
                return None;
            }
        }
        let (&corners, rest) = rest.split_first()?;
        let (sharpness, edges) = rest.split_at_checked(corners as usize)?;
        let mut floats = sharpness.iter().copied();
        let mut given = vertices;
        let mut is_record = |record: &[u32]| match *record {
            [a, b, sharpness, near, far] if a < b => {
                b < vertices && [sharpness, near, far].into_iter().all(is_float)
            }
            [a, b, kind, first, count] => {
                let kinds = [corners, *faces];
                let there = kinds.get(kind as usize).is_some_and(|&kinds| a < kinds);
                let behind = first == given.max(GIVEN as u32);
                let sound = a == b && there && behind && (2..=MOST_GIVEN).contains(&count);
                given = first.saturating_add(count);
                sound
            }
            _ => false,
        };
        let sound = flags <= 3
            && (1..=*words.get(2)?).contains(&corners)
            && floats.all(is_float)
            && edges.chunks(RECORD).all(&mut is_record);
        sound.then(|| Configuration {
            words: words.to_vec(),
        })
    }

    /// The same where the means of all faces of more than so many corners are given, as vertices behind the others; and the vertices of these faces.
    pub(super) fn with_means(mut self, corners: usize) -> (Configuration, Vec<Vec<u32>>) {
        let (mut at, mut first) = (2, self.vertex_count());
        let (mut records, mut means) = (Vec::new(), Vec::new());
        for face in 0..self.words[1] {
            let arity = self.words[at] as usize;
            if arity > corners {
                means.push(self.words[at + 1..=at + arity].to_vec());
                records.extend([face, face, MEAN, first, 1]);
                first += 1;
            }
            at += 1 + arity;
        }
        self.words.extend(records);
        (self, means)
    }

    /// How many faces it lists.
    pub(super) fn face_count(&self) -> u32 {
        self.words[1]
    }

    /// How many vertices these have, with those that are given of hubs.
    pub(super) fn vertex_count(&self) -> u32 {
        let mut at = 2;
        let mut vertices = 0;
        for _ in 0..self.words[1] {
            let arity = self.words[at] as usize;
            let face = &self.words[at + 1..=at + arity];
            vertices = face.iter().fold(vertices, |most, &v| most.max(v + 1));
            at += 1 + arity;
        }
        let records = self.words[at + 1 + self.words[at] as usize..].chunks_exact(RECORD);
        let mut hubs = records.filter(|record| record[0] == record[1]);
        hubs.next_back().map_or(vertices, |hub| hub[3] + hub[4])
    }

    /// The words, for storage.
    pub fn words(&self) -> &[u32] {
        &self.words
    }
}
