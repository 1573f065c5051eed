// Expressions of additions, subtractions and multiplications whose every operation is rounded by itself: twins of `precision::Expression`.
#ifndef PRECISION_GLSL
#define PRECISION_GLSL

#extension GL_EXT_scalar_block_layout : require

layout(constant_id = 0) const uint EXPRESSION = 0u;
// Who evaluates: 0 the vertex, 1 the control, 2 the evaluation shader, 3 none of them.
layout(constant_id = 1) const uint WHO = 0u;

// Empty where expressions are those of an output that is `invariant`.
#ifndef PRECISE
#define PRECISE precise
#endif

struct Input {
    vec4 a;
    vec4 b;
};
layout(set = 0, binding = 0, scalar) readonly buffer Inputs { Input inputs[]; };
layout(set = 0, binding = 1, scalar) buffer Outputs { float outputs[]; };

PRECISE float evaluated(vec4 a, vec4 b) {
    PRECISE float r = 0.0;
    if (EXPRESSION == 0u) r = a.x * b.x + a.y;
    if (EXPRESSION == 1u) r = ((a.x * b.x + a.y * b.y) + a.z * b.z) + a.w * b.w;
    if (EXPRESSION == 2u) r = a.x * b.y - a.y * b.x;
    if (EXPRESSION == 3u) {
        PRECISE float s = 1.0 - b.x;
        PRECISE float t = b.x;
        r = ((a.x * (s * s * s) + a.y * (3.0 * (t * (s * s)))) + a.z * (3.0 * (t * t * s))) + a.w * (t * t * t);
    }
    if (EXPRESSION == 4u) {
        PRECISE float t = b.x;
        PRECISE float p = a.x + t * (a.y - a.x);
        PRECISE float q = a.y + t * (a.z - a.y);
        PRECISE float u = a.z + t * (a.w - a.z);
        PRECISE float v = p + t * (q - p);
        PRECISE float w = q + t * (u - q);
        r = v + t * (w - v);
    }
    if (EXPRESSION == 5u) r = ((a.w * b.x + a.z) * b.x + a.y) * b.x + a.x;
    if (EXPRESSION == 6u) {
        PRECISE float sum = a.x + b.x;
        PRECISE float part = sum - a.x;
        r = (a.x - (sum - part)) + (b.x - part);
    }
    if (EXPRESSION == 7u) r = ((((((a.x + a.y) + a.z) + a.w) + b.x) + b.y) + b.z) + b.w;
    if (EXPRESSION == 8u) r = (a.x * b.x) * (a.y * b.y) - (a.x * b.y) * (a.y * b.x);
    return r;
}

void evaluate(uint who, uint number) {
    if (WHO == who) outputs[number] = evaluated(inputs[number].a, inputs[number].b);
}

#endif
