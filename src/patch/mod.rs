//! Bases and their derivatives: in one dimension, a quad's patch being the product of two, and of triangles. In f64 for the truth, in f32 as twins of the shaders.

pub mod boxspline;
pub mod bspline;
pub mod crease;

use std::ops::{Add, Div, Mul, Sub};

/// The numbers that bases are computed in: f32 and f64.
pub trait Real:
    Copy
    + PartialOrd
    + From<f32>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
}

impl<T> Real for T where
    T: Copy
        + PartialOrd
        + From<f32>
        + Add<Output = T>
        + Sub<Output = T>
        + Mul<Output = T>
        + Div<Output = T>
{
}
