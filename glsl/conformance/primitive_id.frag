#version 460

// The number of the primitive, plus one, as a colour of 24 bits.

layout(location = 0) out vec4 out_colour;

void main() {
    uint number = uint(gl_PrimitiveID) + 1u;
    out_colour = vec4(number & 255u, number >> 8u & 255u, number >> 16u & 255u, 255u) / 255.0;
}
