#version 460

// What is drawn of a surface where its front is seen, as a colour: its number and one more in 24 bits, and an eighth of the patch along u and v. Backs are left out here,
// not by the rasteriser, whose culling drivers do at places of their own.

layout(location = 2) in vec2 in_uv;
layout(location = 4) flat in uint in_drawn;

layout(location = 0) out vec4 out_colour;

void main() {
    if (!gl_FrontFacing) discard;
    uint number = in_drawn + 1u;
    uvec2 eighth = uvec2(clamp(8.0 * in_uv, 0.0, 7.0));
    out_colour = vec4(number & 255u, number >> 8u & 255u, number >> 16u & 255u, 8u * eighth.y + eighth.x) / 255.0;
}
