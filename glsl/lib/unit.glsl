// Unit vectors with the same bits on every device and on the CPU. Twin of `unit` in `method/points.rs`.
#ifndef UNIT_GLSL
#define UNIT_GLSL

// Unit length, or zero where there is no direction, by additions and multiplications alone: these Vulkan wants correctly rounded (Vulkan
// spec, "Precision of Individual Operations"), square roots not.
vec3 unit(vec3 v) {
    // The power of two in the greatest element, and what brings it to 1..2; both are exact.
    uint exponent = floatBitsToUint(max(abs(v.x), max(abs(v.y), abs(v.z)))) & 0x7f800000u;
    if (exponent == 0u || exponent >= 254u << 23) return vec3(0.0);
    precise vec3 scaled = v * uintBitsToFloat((254u << 23) - exponent);
    precise float square = (scaled.x * scaled.x + scaled.y * scaled.y) + scaled.z * scaled.z;
    // Newton's method for 1 / sqrt, which doubles the digits in each step; the first guess has four bits.
    precise float inverse = uintBitsToFloat(0x5f3759dfu - (floatBitsToUint(square) >> 1));
    for (uint i = 0u; i < 4u; ++i) inverse = inverse * (1.5 - (0.5 * square) * (inverse * inverse));
    precise vec3 scaled_to_unit = scaled * inverse;
    return scaled_to_unit;
}

// a x b, each product and difference by itself.
vec3 exact_cross(vec3 a, vec3 b) {
    precise vec3 product = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return product;
}

#endif
