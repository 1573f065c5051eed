//! Refinement levels with every vertex kept as a row of weights over the 1-ring.

use std::borrow::Borrow;
use std::cell::{RefCell, RefMut};
use std::hash::Hash;
use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rustc_hash::FxHashMap;

use crate::mesh::topology::Topology;
use crate::plan::configuration::Configuration;
use crate::plan::options::PlanOptions;
use crate::plan::quarter::Quarter;
use crate::plan::rows::Rows;
use crate::plan::stencil_rows::KnownRows;
use crate::plan::sums::Sums;
use crate::subdivision::{
    BsplinePatch, Mask, Refinement, bspline_patch, limit_stencil, refine, refine_edge,
    refine_vertex,
};

/// A refinement level: some cells in their surroundings, each vertex a row of weights.
#[derive(Clone)]
pub(super) struct Level<'a> {
    steps: &'a Steps,
    step: Arc<Step>,
    pub rows: Sums,
}

impl<'a> Level<'a> {
    /// The configuration's own faces.
    pub fn whole(configuration: &Configuration, steps: &'a Steps) -> Level<'a> {
        let topology = configuration.topology();
        Level {
            steps,
            rows: Sums::identity(topology.vertex_count()),
            step: Arc::new(Step {
                patches: vec![bspline_patch(&topology, 0)],
                masks: Vec::new(),
                topology,
            }),
        }
    }

    /// The level at which the plan of a face begins: the quad itself, or the n-gon's part at its corner 0.
    pub fn base(&self) -> Level<'a> {
        if self.topology().face(0).len() == 4 {
            self.clone()
        } else {
            self.refined(&[(0, 0)])
        }
    }

    /// Its faces.
    pub fn topology(&self) -> &Topology {
        &self.step.topology
    }

    /// A cell as a B-spline, see [`bspline_patch`].
    pub fn patch(&self, cell: u32) -> Option<&BsplinePatch> {
        self.step.patches[cell as usize].as_ref()
    }

    /// The next level of some cells.
    pub fn refined(&self, cells: &[(u32, u32)]) -> Level<'a> {
        let words = cells.iter().flat_map(|&(face, corner)| [face, corner]);
        self.next(CELLS, words, || refine(self.topology(), cells))
    }

    /// The next level of the two halves of an edge; see [`refine_edge`].
    pub fn refined_edge(&self, edge: u32, from: u32, sides: &[u32]) -> Level<'a> {
        let words = [edge, from].into_iter().chain(sides.iter().copied());
        self.next(EDGE, words, || {
            refine_edge(self.topology(), edge, from, sides)
        })
    }

    /// The next level of a vertex, of which all faces around are given by the corners at which they have it; see [`refine_vertex`].
    pub fn refined_vertex(&self, corners: &[(u32, u32)]) -> Level<'a> {
        let words = corners.iter().flat_map(|&(face, corner)| [face, corner]);
        self.next(VERTEX, words, || refine_vertex(self.topology(), corners))
    }

    fn next(
        &self,
        kind: u32,
        chosen: impl Iterator<Item = u32>,
        refine: impl FnOnce() -> Refinement,
    ) -> Level<'a> {
        let step = self.steps.step(self.topology(), kind, chosen, refine);
        Level {
            steps: self.steps,
            rows: self.rows.next(&step.masks),
            step,
        }
    }
}

/// Steps of refinement that were made. Around one extraordinary vertex, and once semi-sharp creases are gone, every step is like the one before, and many
/// plans have the same: what depends on the topology alone is done once.
#[derive(Default)]
pub struct Steps {
    /// Whether plans get weights as shaders have them.
    pub(super) rounded: bool,
    known: Kept<Box<[u32]>, Step>,
    /// Quarters of faces.
    pub(super) quarters: Kept<(PlanOptions, Configuration), Quarter>,
    /// Limits of corners, over the vertices of their rings.
    limits: Kept<Configuration, Vec<f64>>,
    /// Memory for rows, which one plan after another uses.
    memory: RefCell<Vec<f64>>,
    /// The same for what tells rows apart.
    known_rows: RefCell<KnownRows>,
}

/// Steps for threads that build plans: what one leaves the next one goes on with.
#[derive(Default)]
pub(super) struct StepsPool(Mutex<Vec<Steps>>);

/// Steps out of a pool, to which they go back.
pub(super) struct Lent<'a> {
    pool: &'a StepsPool,
    steps: Steps,
}

impl StepsPool {
    /// For plans with weights as shaders have them.
    pub fn rounded(&self) -> Lent<'_> {
        let steps = self.idle().pop();
        Lent {
            pool: self,
            steps: steps.unwrap_or_else(Steps::rounded),
        }
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Steps>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Deref for Lent<'_> {
    type Target = Steps;

    fn deref(&self) -> &Steps {
        &self.steps
    }
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        self.pool.idle().push(std::mem::take(&mut self.steps));
    }
}

/// A step: the next topology, where its vertices come from, and its cells as B-splines; no cells of edges and vertices.
struct Step {
    topology: Topology,
    masks: Vec<Mask>,
    patches: Vec<Option<BsplinePatch>>,
}

/// Topologies of more vertices are not kept.
const SMALL: usize = 128;
/// So many steps are kept, some three megabytes.
const MOST: usize = 1 << 7;
/// What is refined.
const CELLS: u32 = 0;
const EDGE: u32 = 1;
const VERTEX: u32 = 2;

impl Steps {
    /// For plans with weights as shaders have them.
    pub fn rounded() -> Steps {
        Steps {
            rounded: true,
            ..Steps::default()
        }
    }

    /// The memory that [`Steps::leave`] left.
    pub(super) fn memory(&self) -> Vec<f64> {
        self.memory.take()
    }

    /// Leaves the memory of rows to those of the next plan.
    pub(super) fn leave(&self, rows: Rows) {
        self.memory.replace(rows.into_memory());
    }

    /// For the rows of another plan.
    pub(super) fn known_rows(&self) -> RefMut<'_, KnownRows> {
        let mut known = self.known_rows.borrow_mut();
        known.clear();
        known
    }

    fn step(
        &self,
        topology: &Topology,
        kind: u32,
        chosen: impl Iterator<Item = u32>,
        refine: impl FnOnce() -> Refinement,
    ) -> Arc<Step> {
        if topology.vertex_count() > SMALL {
            return Step::new(kind, refine()).into();
        }
        let mut key = vec![kind, 0];
        key.extend(chosen);
        key[1] = key.len() as u32;
        topology.write_down(&mut key);
        if let Some(known) = self.known.get(&key[..]) {
            return known;
        }
        self.known.keep(key.into(), Step::new(kind, refine()))
    }

    /// The limit at the vertex whose ring it is: a weight for each vertex of the ring.
    pub(super) fn limit(&self, of: Configuration) -> Arc<Vec<f64>> {
        if let Some(known) = self.limits.get(&of) {
            return known;
        }
        let mut level = Level::whole(&of, self);
        let limit = loop {
            if let Some(limit) = limit_stencil(level.topology(), 0, 0) {
                break limit.position;
            }
            level = level.refined(&[(0, 0)]);
        };
        let mut weights = vec![0.0; level.rows.width()];
        level.rows.add_to(&mut weights, &limit);
        if weights.len() > SMALL {
            return weights.into();
        }
        self.limits.keep(of, weights)
    }
}

/// What was made once, up to a number of things; then it begins anew.
pub(super) struct Kept<K, V>(RefCell<FxHashMap<K, Arc<V>>>);

impl<K, V> Default for Kept<K, V> {
    fn default() -> Self {
        Kept(RefCell::default())
    }
}

impl<K: Eq + Hash, V> Kept<K, V> {
    pub fn get<Q: Eq + Hash + ?Sized>(&self, key: &Q) -> Option<Arc<V>>
    where
        K: Borrow<Q>,
    {
        self.0.borrow().get(key).cloned()
    }

    pub fn keep(&self, key: K, value: V) -> Arc<V> {
        let value = Arc::new(value);
        let mut known = self.0.borrow_mut();
        if known.len() == MOST {
            known.clear();
        }
        known.insert(key, value.clone());
        value
    }
}

impl Step {
    fn new(kind: u32, refinement: Refinement) -> Step {
        let Refinement {
            topology,
            masks,
            cells,
        } = refinement;
        let cells = 0..if kind == CELLS { cells } else { 0 };
        Step {
            patches: cells.map(|cell| bspline_patch(&topology, cell)).collect(),
            topology,
            masks,
        }
    }
}
