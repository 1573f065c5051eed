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

/// A vector over a power of two: the greatest element is 2..4. Zero for one without a direction, which is not finite, or subnormal as a whole.
pub fn scaled(v: Vec3) -> Vec3 {
    let bits = v.to_array().map(|x| x.to_bits() & EXPONENT);
    let greatest = greatest_exponent(v);
    if greatest == 0 || greatest == EXPONENT {
        return Vec3::ZERO;
    }
    let factor = f32::from_bits((255 << 23) - greatest);
    let is_lost = |i: usize| bits[i] == 0 || bits[i] + (LOST << 23) < greatest;
    let grown = |i: usize| if is_lost(i) { 0.0 } else { v[i] * factor };
    Vec3::from([0, 1, 2].map(grown))
}

/// The exponent of a vector's greatest element, in its place among the bits of a float.
pub fn greatest_exponent(v: Vec3) -> u32 {
    let bits = v.to_array().map(|x| x.to_bits() & EXPONENT);
    bits[0].max(bits[1]).max(bits[2])
}

/// The power of two that brings vectors of which this is the greatest exponent to 1..4, from where sums and products of many of them stay far within
/// the range of floats; 0 where there is none.
pub fn factor_for(exponent: u32) -> f32 {
    if exponent == 0 || exponent == EXPONENT {
        return 0.0;
    }
    f32::from_bits(((254 << 23) - exponent).max(1 << 23))
}

/// A vector times such a power. What is subnormal is zero: devices may take it for that.
pub fn sized(v: Vec3, factor: f32) -> Vec3 {
    let sized = |x: f32| match x.to_bits() & EXPONENT {
        0 => 0.0,
        _ => factor * x,
    };
    Vec3::from(v.to_array().map(sized))
}

/// The direction from `a` to `b`, both of any size; zero where there is none.
pub fn direction(a: Vec3, b: Vec3) -> Vec3 {
    let factor = factor_for(greatest_exponent(a).max(greatest_exponent(b)));
    match factor {
        0.0 => Vec3::ZERO,
        _ => unit(sized(b, factor) - sized(a, factor)),
    }
}

/// Unit length, or zero where there is no direction. No zero is negative.
pub fn unit(v: Vec3) -> Vec3 {
    let v = scaled(v);
    let square = v.x * v.x + v.y * v.y + v.z * v.z;
    if square == 0.0 {
        return Vec3::ZERO;
    }
    // Newton's method for 1 / sqrt, which doubles the digits in each step; the first guess has four bits.
    let mut inverse = f32::from_bits(0x5f37_59df - (square.to_bits() >> 1));
    for _ in 0..4 {
        inverse *= 1.5 - (0.5 * square) * (inverse * inverse);
    }
    v * inverse
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
        let [x, y, z] = unit(Vec3::new(-0.0, -subnormal, -5.0)).to_array();
        assert_eq!([x, y].map(f32::to_bits), [0; 2]);
        assert!((z + 1.0).abs() <= f32::EPSILON, "{z}");
    }

    #[test]
    fn factors_lead_to_where_sums_have_room() {
        for greatest in [f32::MIN_POSITIVE, 1e-20, 1.0, 1e20, f32::MAX] {
            let factor = factor_for(greatest_exponent(Vec3::new(0.0, -greatest, 1e-40)));
            assert!((1.0..4.0).contains(&(greatest * factor)), "{greatest}");
        }
        for none in [0.0, 1e-40, f32::INFINITY, f32::NAN] {
            assert_eq!(factor_for(greatest_exponent(Vec3::splat(none))), 0.0);
        }
    }

    #[test]
    fn directions_are_of_any_two_points() {
        for size in SIZES.into_iter().chain([f32::MAX]) {
            let (a, b) = (Vec3::new(-size, size, 0.0), Vec3::new(size, -size, 0.0));
            let right = Vec3::new(1.0, -1.0, 0.0).normalize();
            assert!(direction(a, b).distance(right) < 3e-7, "{size}");
            assert_eq!(direction(a, a), Vec3::ZERO);
        }
        for none in [f32::INFINITY, f32::NAN] {
            assert_eq!(direction(Vec3::splat(none), Vec3::ONE), Vec3::ZERO);
        }
    }

    #[test]
    fn powers_of_two_change_no_bit() {
        let v = Vec3::new(0.7, -0.3, 1.0 / 3.0);
        for exponent in -100..=126 {
            assert_eq!(unit(v * 2f32.powi(exponent)), unit(v), "2^{exponent}");
        }
    }
}
