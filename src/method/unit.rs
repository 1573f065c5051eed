//! Directions of vectors of any size, with the same bits on every device and on the CPU. Twin of `glsl/lib/unit.glsl`.
//!
//! Only additions and multiplications are used, which Vulkan wants correctly rounded (Vulkan spec, "Precision of Individual Operations"), where
//! square roots and quotients are not. Vectors are brought to about unit size first, exactly, by powers of two: so nothing overflows that is
//! finite. Nothing becomes subnormal either, which devices may flush to zero and the CPU does not ("Rounding and Denormalization"): elements that
//! are subnormal, or smaller than 2^-48 of the greatest, are zero. In products of two that leaves 2^-96, whose last place is 2^-119.

use glam::Vec3;

/// Where the exponent of a float is.
const EXPONENT: u32 = 0x7f80_0000;
/// So many powers of two below the greatest element nothing is left.
const LOST: u32 = 48;
/// So many powers of two apart the smaller of two vectors counts for nothing in their sum.
const APART: i32 = 50;

/// A vector over a power of two.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scaled {
    /// The greatest element is 2..4; zero for vectors without a direction.
    pub vector: Vec3,
    /// Of the power of two.
    pub exponent: i32,
}

/// A vector as one of about unit size. What is not finite, or subnormal as a whole, has no direction.
pub fn scaled(v: Vec3) -> Scaled {
    let bits = v.to_array().map(|x| x.to_bits() & EXPONENT);
    let greatest = bits[0].max(bits[1]).max(bits[2]);
    if greatest == 0 || greatest == EXPONENT {
        return Scaled::default();
    }
    let factor = f32::from_bits((255 << 23) - greatest);
    let is_lost = |i: usize| bits[i] == 0 || bits[i] + (LOST << 23) < greatest;
    let grown = |i: usize| if is_lost(i) { 0.0 } else { v[i] * factor };
    Scaled {
        vector: Vec3::from([0, 1, 2].map(grown)),
        exponent: (greatest >> 23) as i32 - 128,
    }
}

/// Unit length, or zero where there is no direction. No zero is negative.
pub fn unit(v: Vec3) -> Vec3 {
    let v = scaled(v).vector;
    let square = v.x * v.x + v.y * v.y + v.z * v.z;
    // Newton's method for 1 / sqrt, which doubles the digits in each step; the first guess has four bits.
    let mut inverse = f32::from_bits(0x5f37_59df - (square.to_bits() >> 1));
    for _ in 0..4 {
        inverse *= 1.5 - (0.5 * square) * (inverse * inverse);
    }
    v * inverse
}

/// a - b, halved first where it might leave the range of floats.
pub fn difference(a: Vec3, b: Vec3) -> Scaled {
    let greatest = a.abs().max(b.abs()).to_array().map(f32::to_bits);
    let is_large = greatest.iter().any(|bits| bits & EXPONENT >= 254 << 23);
    let share = if is_large { 0.5 } else { 1.0 };
    scaled(share * a - share * b).grown(i32::from(is_large))
}

/// a x b.
pub fn cross(a: Scaled, b: Scaled) -> Scaled {
    scaled(a.vector.cross(b.vector)).grown(a.exponent + b.exponent)
}

/// a + b.
pub fn sum(a: Scaled, b: Scaled) -> Scaled {
    let apart = b.exponent - a.exponent;
    if b.vector == Vec3::ZERO || a.vector != Vec3::ZERO && apart < -APART {
        return a;
    }
    if a.vector == Vec3::ZERO || apart > APART {
        return b;
    }
    let exponent = a.exponent.max(b.exponent);
    let part = |v: Scaled| v.vector * power_of_two(v.exponent - exponent);
    scaled(part(a) + part(b)).grown(exponent)
}

impl Scaled {
    /// Times a power of two.
    fn grown(self, exponent: i32) -> Scaled {
        Scaled {
            exponent: self.exponent + exponent,
            ..self
        }
    }
}

/// 2^exponent, exactly.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((127 + exponent) as u32) << 23)
}

/// The power of two that brings vectors with this greatest element to about 2^64, from where sums of many of them with any weights stay within the
/// range of floats; 0 where there is none.
pub fn factor_for(greatest: f32) -> f32 {
    let exponent = greatest.to_bits() & EXPONENT;
    if exponent == 0 || exponent == EXPONENT {
        return 0.0;
    }
    f32::from_bits((318 - (exponent >> 23)).min(254) << 23)
}

/// Whether sums that led to a vector can be trusted: neither has it left the range of floats, nor can anything subnormal have had a say.
pub fn is_firm(v: Vec3) -> bool {
    let bits = v.to_array().map(|x| x.to_bits() & EXPONENT);
    let greatest = bits[0].max(bits[1]).max(bits[2]);
    (87 << 23..227 << 23).contains(&greatest)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [f32; 7] = [f32::MIN_POSITIVE, 1e-30, 1e-3, 1.0, 7e5, 1e30, 1.6e38];

    #[test]
    fn unit_vectors_have_unit_length_whatever_the_size() {
        for size in SIZES {
            for v in [
                Vec3::X,
                Vec3::new(1.0, -2.0, 1.5),
                Vec3::new(-1e-6, 1.0, 1.9),
            ] {
                let unit = unit(size * v).as_dvec3();
                assert!((unit.length() - 1.0).abs() < 3e-7, "{size} {v}: {unit}");
                // The least element of the least vector is subnormal, and so nothing.
                assert!(unit.distance(v.as_dvec3().normalize()) < 1e-6, "{size} {v}");
            }
        }
    }

    #[test]
    fn what_has_no_direction_is_zero_and_no_zero_is_negative() {
        let subnormal = f32::MIN_POSITIVE / 2.0;
        for x in [0.0, -0.0, subnormal, f32::INFINITY, f32::NAN, -f32::NAN] {
            for v in [Vec3::splat(x), Vec3::new(0.0, x, 0.0)] {
                assert_eq!(unit(v).to_array().map(f32::to_bits), [0; 3], "{v}");
            }
        }
        assert_eq!(unit(Vec3::new(1.0, f32::NAN, 3.0)), Vec3::ZERO);
        let axis = unit(Vec3::new(-0.0, -subnormal, -5.0));
        assert_eq!(
            axis.to_array().map(f32::to_bits),
            [0.0f32, 0.0, -1.0].map(f32::to_bits)
        );
    }

    #[test]
    fn powers_of_two_change_no_bit() {
        let v = Vec3::new(0.7, -0.3, 1.0 / 3.0);
        for exponent in -100..=126 {
            assert_eq!(unit(v * power_of_two(exponent)), unit(v), "2^{exponent}");
        }
    }

    #[test]
    fn faces_of_any_size_have_normals() {
        for size in SIZES {
            let [a, b] = [Vec3::new(1.9, 0.0, 0.0), Vec3::new(-1.9, 1.9, 0.0)].map(|v| size * v);
            let normal = cross(difference(a, b), difference(b, -a));
            assert_eq!(unit(normal.vector), -Vec3::Z, "{size}");
            // The largest face has a say; a tiny one beside it has none, unless it is alone.
            let tiny = cross(
                difference(1e-30 * Vec3::X, Vec3::ZERO),
                difference(1e-30 * Vec3::Z, Vec3::ZERO),
            );
            if size >= 1e-3 {
                assert_eq!(sum(normal, tiny), normal);
                assert_eq!(sum(tiny, normal), normal);
            }
            assert_eq!(sum(tiny, Scaled::default()), tiny);
            assert_eq!(sum(Scaled::default(), normal), normal);
        }
    }

    #[test]
    fn factors_lead_to_where_sums_have_room() {
        for greatest in [1e-38, 1e-20, 1.0, 1e20, 3.4e38f32] {
            let grown = greatest * factor_for(greatest);
            assert!((1.0..4e19).contains(&grown), "{greatest}: {grown}");
        }
        assert_eq!([0.0, f32::INFINITY].map(factor_for), [0.0; 2]);
        assert_eq!(
            [1e-20, 1.0, 1e30, 1e35].map(|x| is_firm(Vec3::new(0.0, x, 0.0))),
            [false, true, true, false]
        );
    }
}
