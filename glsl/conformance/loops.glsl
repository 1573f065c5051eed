// Sums over a stretch of a table whose length differs from invocation to invocation, by loops of several forms.
#ifndef LOOPS_GLSL
#define LOOPS_GLSL

#extension GL_EXT_scalar_block_layout : require

// Twin of `loops::FORMS`.
layout(constant_id = 0) const uint FORM = 0u;

// A power of two of them.
layout(set = 0, binding = 0, scalar) readonly buffer Terms { uint terms[]; };

struct Sum {
    uint value;
    // What was added last.
    uint last;
    uint turns;
};
layout(set = 0, binding = 1, scalar) buffer Sums { Sum sums[]; };

uint term(uint place) { return terms[place % uint(terms.length())]; }

void add(inout Sum sum, uint start) {
    sum.last = term(start + sum.turns);
    sum.value = 1664525u * sum.value + sum.last;
    ++sum.turns;
}

// At least one term. Twin of `loops::sum`.
Sum sum_of(uint start, uint count) {
    Sum sum = Sum(0u, 0u, 0u);
    if (FORM == 0u) {
        // Tested at its beginning.
        for (uint i = 0u; i < count; ++i) add(sum, start);
    } else if (FORM == 1u) {
        // Tested at its end.
        do add(sum, start); while (sum.turns < count);
    } else if (FORM == 2u) {
        // Left in its middle.
        for (uint i = 0u;; ++i) {
            if (i == count) break;
            add(sum, start);
        }
    } else if (FORM == 3u) {
        // Left at its end by a jump.
        while (true) {
            add(sum, start);
            if (sum.turns == count) break;
        }
    } else if (FORM == 4u) {
        // Turns that are skipped.
        for (uint i = 0u; i < 2u * count; ++i) {
            if ((i & 1u) == 0u) continue;
            add(sum, start);
        }
    } else if (FORM == 5u) {
        // A loop tested at its end around one that is tested at its beginning, and stops early.
        do {
            uint most = min(sum.turns + 3u, count);
            for (uint i = sum.turns; i < most; ++i) add(sum, start);
        } while (sum.turns < count);
    } else {
        // The other way round.
        for (uint i = 0u; sum.turns < count; ++i) {
            uint most = min(sum.turns + 3u, count);
            do add(sum, start); while (sum.turns < most);
        }
    }
    return sum;
}

#endif
