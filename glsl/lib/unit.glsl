// Directions of vectors of any size, with the same bits on every device and on the CPU. Twin of `method/unit.rs`, where it is told how.
#ifndef UNIT_GLSL
#define UNIT_GLSL

// Where the exponent of a float is.
const uint EXPONENT = 0x7f800000u;
// So many powers of two below the greatest element nothing is left.
const uint LOST = 48u;
// So many powers of two apart the smaller of two vectors counts for nothing in their sum.
const int APART = 50;

// A vector over a power of two: the greatest element is 2..4, or all are zero for want of a direction.
struct Scaled {
    vec3 vector;
    int exponent;
};

// 2^exponent, exactly.
float power_of_two(int exponent) { return intBitsToFloat((127 + exponent) << 23); }

// The exponent of the greatest element, in its place.
uint greatest_exponent(vec3 v) {
    uvec3 bits = floatBitsToUint(v) & EXPONENT;
    return max(bits.x, max(bits.y, bits.z));
}

// A vector as one of about unit size. What is not finite, or subnormal as a whole, has no direction.
Scaled scaled(vec3 v) {
    uint greatest = greatest_exponent(v);
    if (greatest == 0u || greatest == EXPONENT) return Scaled(vec3(0.0), 0);
    precise vec3 grown = v * uintBitsToFloat((255u << 23) - greatest);
    uvec3 bits = floatBitsToUint(v) & EXPONENT;
    uvec3 reach = mix(bits + (LOST << 23), uvec3(0u), equal(bits, uvec3(0u)));
    return Scaled(mix(grown, vec3(0.0), lessThan(reach, uvec3(greatest))), int(greatest >> 23) - 128);
}

// Unit length, or zero where there is no direction. No zero is negative.
vec3 unit(vec3 v) {
    precise vec3 sized = scaled(v).vector;
    precise float square = (sized.x * sized.x + sized.y * sized.y) + sized.z * sized.z;
    // Newton's method for 1 / sqrt, which doubles the digits in each step; the first guess has four bits.
    precise float inverse = uintBitsToFloat(0x5f3759dfu - (floatBitsToUint(square) >> 1));
    for (uint i = 0u; i < 4u; ++i) inverse = inverse * (1.5 - (0.5 * square) * (inverse * inverse));
    precise vec3 to_unit = sized * inverse;
    return to_unit;
}

// a x b, each product and difference by itself.
vec3 exact_cross(vec3 a, vec3 b) {
    precise vec3 product = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return product;
}

// a - b, halved first where it might leave the range of floats.
Scaled difference(vec3 a, vec3 b) {
    bool is_large = max(greatest_exponent(a), greatest_exponent(b)) >= 254u << 23;
    float share = is_large ? 0.5 : 1.0;
    precise vec3 apart = share * a - share * b;
    Scaled found = scaled(apart);
    return Scaled(found.vector, found.exponent + int(is_large));
}

// a x b.
Scaled scaled_cross(Scaled a, Scaled b) {
    Scaled product = scaled(exact_cross(a.vector, b.vector));
    return Scaled(product.vector, product.exponent + a.exponent + b.exponent);
}

// a + b.
Scaled scaled_sum(Scaled a, Scaled b) {
    bool a_counts = a.vector != vec3(0.0);
    int apart = b.exponent - a.exponent;
    if (b.vector == vec3(0.0) || (a_counts && apart < -APART)) return a;
    if (!a_counts || apart > APART) return b;
    int exponent = max(a.exponent, b.exponent);
    precise vec3 both = a.vector * power_of_two(a.exponent - exponent) + b.vector * power_of_two(b.exponent - exponent);
    Scaled found = scaled(both);
    return Scaled(found.vector, found.exponent + exponent);
}

// The power of two that brings vectors with this greatest exponent to about 2^64, from where sums of many of them with any weights stay within the
// range of floats; 0 where there is none.
float factor_for(uint exponent) {
    if (exponent == 0u || exponent == EXPONENT) return 0.0;
    return uintBitsToFloat(min(318u - (exponent >> 23), 254u) << 23);
}

// Whether sums that led to a vector can be trusted: neither has it left the range of floats, nor can anything subnormal have had a say.
bool is_firm(vec3 v) {
    uint greatest = greatest_exponent(v);
    return greatest >= 87u << 23 && greatest < 227u << 23;
}

#endif
