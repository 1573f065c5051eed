#version 460

// What the geometry shader took for its number, plus one, as a colour of 24 bits.

layout(location = 1) flat in uint in_number;
layout(location = 0) out vec4 out_colour;

void main() {
    uint number = in_number + 1u;
    out_colour = vec4(number & 255u, number >> 8u & 255u, number >> 16u & 255u, 255u) / 255.0;
}
