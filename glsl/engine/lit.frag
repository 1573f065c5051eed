#version 460
#extension GL_GOOGLE_include_directive : require

// The fragment shader of examples/engine: a material an instance, a soft sun with shadows, and haze. Set 3 is the engine's own.

#include "lib/interface.glsl"

layout(location = 0) in vec3 in_position;
layout(location = 1) centroid in vec3 in_normal;
layout(location = 4) flat in uint in_drawn;
// The derivative by u, which pipelines have that ask for tangents.
layout(location = 5) centroid in vec3 in_du;

layout(location = 0) out vec4 out_colour;

// Twins of `Instance` and `Light` in examples/engine/scene.rs.
struct Instance {
    mat4 world_from_model;
    vec3 colour;
    float gloss;
    float brushed;
    vec2 roughness;
    float highlight;
};
struct Light {
    mat4 shadow_from_world;
    vec3 sun;
    float softness;
    vec3 eye;
    float haze;
};
layout(set = 3, binding = 0, scalar) uniform LightBlock { Light light; };
layout(set = 3, binding = 1) uniform sampler2DShadow shadow_map;
layout(set = 3, binding = 2, scalar) readonly buffer InstanceTable { Instance instances[]; };

const vec3 SKY = vec3(0.48, 0.60, 0.74);

// How much of the sun is seen: 16 places on a disc, turned from pixel to pixel, each filtered.
float sunlight(vec3 world, vec3 normal) {
    vec4 at = light.shadow_from_world * vec4(world + normal * light.softness * 8.0, 1.0);
    float turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    float lit = 0.0;
    for (uint i = 0u; i < 16u; ++i) {
        float angle = turn + 2.3999632 * float(i);
        vec2 offset = sqrt((float(i) + 0.5) / 16.0) * vec2(cos(angle), sin(angle)) * light.softness;
        lit += texture(shadow_map, vec3(0.5 + 0.5 * at.xy + offset, at.z));
    }
    return lit / 16.0;
}

// The highlight of brushed metal (Ward 1992): its grooves run along u, and it is narrow along them and wide across.
float brushed_highlight(vec3 normal, vec3 along, vec3 halfway, vec2 roughness) {
    vec3 groove = along - dot(along, normal) * normal;
    if (dot(groove, groove) == 0.0) return 0.0;
    groove = normalize(groove);
    vec2 slope = vec2(dot(halfway, groove), dot(halfway, cross(normal, groove))) / roughness;
    return exp(-2.0 * dot(slope, slope) / (1.0 + max(dot(halfway, normal), 0.0)));
}

void main() {
    Instance instance = instances[drawn_view(in_drawn)];
    vec3 world = (instance.world_from_model * vec4(in_position, 1.0)).xyz;
    vec3 normal = normalize(mat3(instance.world_from_model) * in_normal);
    vec3 to_eye = light.eye - world;
    float far = length(to_eye);
    to_eye /= far;
    if (dot(normal, to_eye) < 0.0) normal -= 2.0 * dot(normal, to_eye) * to_eye;
    float facing = dot(normal, light.sun);
    // Wrapped a little around the edge, as light is by what is not quite hard.
    float direct = smoothstep(-0.08, 1.0, facing) * sunlight(world, normal);
    // The sky from above, what the ground throws back from below, and less of either close to the ground.
    float open = mix(0.55, 1.0, smoothstep(0.0, 0.8, world.y + 0.5 * normal.y));
    vec3 ambient = mix(vec3(0.12, 0.095, 0.075), vec3(0.17, 0.21, 0.29), 0.5 + 0.5 * normal.y) * open;
    vec3 halfway = normalize(light.sun + to_eye);
    float grazing = pow(1.0 - max(dot(normal, to_eye), 0.0), 5.0);
    vec3 along = mat3(instance.world_from_model) * in_du;
    float plain = pow(max(dot(normal, halfway), 0.0), 48.0);
    float highlight = mix(plain, brushed_highlight(normal, along, halfway, instance.roughness), instance.brushed) * direct;
    vec3 colour = instance.colour * (ambient + vec3(1.00, 0.88, 0.70) * direct);
    colour += instance.gloss * (instance.highlight * highlight * vec3(1.0, 0.95, 0.85) + 0.20 * grazing * SKY * open);
    out_colour = vec4(mix(SKY, colour, exp(-pow(far * light.haze, 3.0))), 1.0);
}
