// Directions of vectors of any size, with the same bits on every device and on the CPU. Twin of `method/unit.rs`, where it is told how.
#ifndef UNIT_GLSL
#define UNIT_GLSL

// Where the exponent of a float is.
const uint EXPONENT = 0x7f800000u;
// So many powers of two below the greatest element nothing is left.
const uint LOST = 48u;

// 2^exponent, exactly.
float power_of_two(int exponent) { return intBitsToFloat((127 + exponent) << 23); }

// The exponent of a vector's greatest element, in its place among the bits of a float.
uint greatest_exponent(vec3 v) {
    uvec3 bits = floatBitsToUint(v) & EXPONENT;
    return max(bits.x, max(bits.y, bits.z));
}

// The power of two that brings vectors of which this is the greatest exponent to 1..4, from where sums and products of many of them stay far within the
// range of floats; 0 where there is none.
float factor_for(uint exponent) {
    if (exponent == 0u || exponent == EXPONENT) return 0.0;
    return uintBitsToFloat(max((254u << 23) - exponent, 1u << 23));
}

// A vector times such a power. What is subnormal is zero: devices may take it for that.
vec3 sized(vec3 v, float factor) {
    precise vec3 grown = factor * v;
    return mix(grown, vec3(0.0), equal(floatBitsToUint(v) & EXPONENT, uvec3(0u)));
}

// A vector over a power of two: the greatest element is 2..4. Zero for one without a direction, which is not finite, or subnormal as a whole.
vec3 scaled(vec3 v) {
    uvec3 bits = floatBitsToUint(v) & EXPONENT;
    uint greatest = greatest_exponent(v);
    if (greatest == 0u || greatest == EXPONENT) return vec3(0.0);
    precise vec3 grown = v * uintBitsToFloat((255u << 23) - greatest);
    uvec3 reach = mix(bits + (LOST << 23), uvec3(0u), equal(bits, uvec3(0u)));
    return mix(grown, vec3(0.0), lessThan(reach, uvec3(greatest)));
}

// Unit length, or zero where there is no direction. No zero is negative.
vec3 unit(vec3 v) {
    precise vec3 about_unit = scaled(v);
    precise float square = (about_unit.x * about_unit.x + about_unit.y * about_unit.y) + about_unit.z * about_unit.z;
    if (square == 0.0) return vec3(0.0);
    // Newton's method for 1 / sqrt, which doubles the digits in each step; the first guess has four bits.
    precise float inverse = uintBitsToFloat(0x5f3759dfu - (floatBitsToUint(square) >> 1));
    for (uint i = 0u; i < 4u; ++i) inverse = inverse * (1.5 - (0.5 * square) * (inverse * inverse));
    precise vec3 to_unit = about_unit * inverse;
    return to_unit;
}

// a . b, each product and sum by itself.
float exact_dot(vec3 a, vec3 b) {
    precise float sum = (a.x * b.x + a.y * b.y) + a.z * b.z;
    return sum;
}

// The direction from `a` to `b`, both of any size; zero where there is none.
vec3 direction(vec3 a, vec3 b) {
    float factor = factor_for(max(greatest_exponent(a), greatest_exponent(b)));
    precise vec3 apart = sized(b, factor) - sized(a, factor);
    return factor == 0.0 ? vec3(0.0) : unit(apart);
}

// a x b, each product and difference by itself.
vec3 exact_cross(vec3 a, vec3 b) {
    precise vec3 product = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return product;
}

#endif
