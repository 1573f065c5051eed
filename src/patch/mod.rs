//! Bases and their derivatives, in one dimension: a patch is the product of two.

pub mod bspline;
pub mod crease;
