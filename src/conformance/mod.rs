//! The suite of `hullform verify`: does a driver keep the rules that we rely on, and do we keep our own?
//!
//! Cases are named `group.subgroup.case`. Each states its rule and where that is written, and reports what it measured. A group is a file
//! here and a row of [`GROUPS`]. The suite runs its cases in worker processes ([`Runner`]), so that a driver's crash or hang ends one
//! case and no more; and holds results to a list of what the driver is known to do wrong ([`Expectations`]).
//!
//! Raw groups (`coordinates`, `connectivity`, `winding`, `scale`, `draws`, `primitive_id`, `io`, `barriers`, `loops`, `precision`, `visibility`) have small shaders of their own in `glsl/conformance` and know nothing of subdivision:
//! what they find is the driver's. The others draw our surfaces.
//!
//! What the suite found in drivers stands in [`bugs`].

pub mod backends;
mod barriers;
mod bench;
pub mod bugs;
mod capture;
mod case;
mod compute_visibility;
mod connectivity;
mod context;
mod coordinates;
pub mod deqp;
mod determinism;
mod draws;
pub mod edges;
mod expectations;
mod geometry;
mod io;
mod limit;
mod loads;
mod loops;
mod meshes;
mod models;
mod modes;
mod opened;
mod pictures;
mod precision;
mod primitive_id;
mod program;
mod random;
mod raw;
mod registry;
mod report;
mod robustness;
mod runner;
mod scale;
mod state;
mod statistics;
mod visibility;
mod winding;
mod witness;
mod worker;

pub use case::{Case, Check, Finding, Group, LIMIT, Status};
pub use context::{Context, Fault, FaultKind, Settings};
pub use expectations::{Cases, Expectation, Expectations, Lists};
pub use opened::Opened;
pub use pictures::Picture;
pub use program::own_program;
pub use random::Random;
pub use registry::{GROUPS, Registry, SMOKE};
pub use report::{CaseResult, Report};
pub use runner::{RunOptions, Runner, Turn};
pub use worker::work;
