// Adaptive quadtrees (Brainerd et al. 2016) for faces that are no plain B-splines. Twin of `method/quadtree/twin.rs`.
//
// The control points of a patch are the vertices of its 1-ring, up to 32; with LONG_RINGS, what a longer ring has beyond these is fetched by the
// control shader itself (section 5).
//
// A patch's slot in the scratch ring begins with a head for each of its uses: the origin that the use's points are relative to, and where
// these begin in the slot. Then come the plain vertices of its border, and the points of each plan.
#ifndef QUADTREE_METHOD_GLSL
#define QUADTREE_METHOD_GLSL

#ifndef CACHED_POINTS
#define SCRATCH_RING
#endif
#define COUNTED_EDGES

#include "lib/border.glsl"
#include "lib/cell.glsl"
#include "lib/control_vertex.glsl"
#include "lib/corner.glsl"
#include "lib/levels.glsl"
#include "lib/quadtree.glsl"
#include "lib/scratch.glsl"

#ifdef CACHED_POINTS
// Nothing goes from stage to stage but the patch's number.
const uint CONTROL_POINTS = 1u;
#define CONTROL_VERTICES 1

vec3 control_point(Patch record, uint number) { return vec3(0.0); }
vec3 patch_point(Patch record, uint number) { return vec3(0.0); }
#else
const uint CONTROL_POINTS = CONTROL_INVOCATIONS;
#define CONTROL_VERTICES 32
#endif

#if defined(STAGE_VERTEX) && !defined(CACHED_POINTS)
vec3 control_point(Patch record, uint number) {
    uint ring = max(record.flags >> PATCH_RING_SHIFT & 63u, 1u);
    return control_vertex(control_at(record.controls + min(number, ring - 1u)));
}
#endif

// Whether the patch is the mirror image of what its inside's plan is for, with u and v exchanged.
bool is_mirrored(Patch record) { return (record.flags & PATCH_MIRRORED) != 0u; }

// The use of the corner that a plan of the inside means by a STENCIL_CORNER.
uint use_of_corner(Patch record, uint corner) {
    uint plain = min(corner, USES - 1u);
    return is_mirrored(record) ? STENCIL_CORNER + (3u & (4u + STENCIL_CORNER - plain)) : plain;
}

#if defined(STAGE_COMPUTE) || (defined(STAGE_CONTROL) && !defined(CACHED_POINTS))
// Lists of places in the patch's ring.
#ifdef LONG_RINGS
const uint BITS_A_PLACE = LONG_PLACE_BITS;
#else
const uint BITS_A_PLACE = PLACE_BITS;
#endif
const uint PLACES_A_WORD = 32u / BITS_A_PLACE;

// The first place of a word of them.
uint first_place(uint word) { return word & ((1u << BITS_A_PLACE) - 1u); }

// Place `i` of the list that begins at `list`.
uint place_at(uint list, uint i) {
    return first_place(control_at(list + i / PLACES_A_WORD) >> BITS_A_PLACE * (i % PLACES_A_WORD));
}

#ifdef LONG_RINGS
#ifdef STAGE_COMPUTE
// A point that is computed beforehand. In a pose with a cache they come first there, two vectors each.
Point hub_point(uint number) { return Point(cached[2u * number], cached[2u * number + 1u]); }
#else
layout(set = SET_POSE, binding = BINDING_POINTS, scalar) readonly buffer HubTable { Point points[]; };
Point hub_point(uint number) { return points[number]; }
#endif

// From `origin` to a point of a hub, which is relative to one of the hub's vertices.
vec3 hub_spoke(uint named, vec3 origin) {
    Point hub = hub_point(named & ~HUB_POINT);
    precise vec3 spoke = hub.position + (hub.normal - origin);
    return spoke;
}
#endif

// A vertex of the patch's 1-ring. The index is clamped although it is only used when it is small: a driver may fetch first and choose then. What is given of
// hubs stands behind what the vertex shader hands on.
vec3 ring_point(Patch record, uint place) {
#ifdef LONG_RINGS
    uint named = place < CONTROL_INVOCATIONS ? 0u : control_at(record.controls + place);
    if ((named & HUB_POINT) != 0u) return hub_spoke(named, vec3(0.0));
#endif
#if defined(STAGE_COMPUTE) || defined(FETCHED_RINGS)
    return control_vertex(control_at(record.controls + place));
#else
    vec3 piped = in_point[min(place, CONTROL_INVOCATIONS - 1u)];
#ifdef LONG_RINGS
    return place < CONTROL_INVOCATIONS ? piped : control_vertex(named);
#else
    return piped;
#endif
#endif
}

// From `origin` to it.
vec3 ring_spoke(Patch record, uint place, vec3 origin) {
#ifdef LONG_RINGS
    uint named = place < CONTROL_INVOCATIONS ? 0u : control_at(record.controls + place);
    if ((named & HUB_POINT) != 0u) return hub_spoke(named, origin);
#endif
    precise vec3 spoke = ring_point(record, place) - origin;
    return spoke;
}

// Adds `term` to a sum of many, and keeps what rounding takes away (Kahan 1965).
void add_compensated(inout vec3 sum, inout vec3 lost, vec3 term) {
    precise vec3 rest = term - lost;
    precise vec3 next = sum + rest;
    precise vec3 more = (next - sum) - rest;
    sum = next;
    lost = more;
}

// Adds `term` to a sum of `count` terms.
void add_term(inout vec3 sum, inout vec3 lost, vec3 term, uint count) {
#ifdef LONG_RINGS
    if (count > CONTROL_INVOCATIONS) {
        add_compensated(sum, lost, term);
    } else {
        precise vec3 next = sum + term;
        sum = next;
    }
#else
    precise vec3 next = sum + term;
    sum = next;
#endif
}

// The ring of a use: how many vertices it has, where the list of their places in the patch's ring begins, and its first stencil. Of the inside, whose ring is
// the patch's, the list is the order in which stencils are summed, that of the vertices' numbers in the mesh: so faces that share a point give it the
// same bits.
struct Ring {
    uint size;
    uint places;
    uint rows;
    bool inside;
};

// Tables are read word by word: of a record that is passed by value, compilers copy all for each invocation.
//
// Bounded by the words that there are for so many stencils: a plan that is garbage must not keep the device busy for ever. The host sees to it that
// sound plans are within.
Ring use_ring(Patch record, uint number, uint stencils) {
    uint used = use_of(record, number);
    uint size = uses[used].size;
    precise float needed = float(size) * float(stencils);
    precise float most = float(PRODUCTS_A_WORD) * float(weights.length());
    uint places = number == 0u ? record.controls + size : uses[used].ring;
    return Ring(needed <= most ? size : 0u, places, uses[used].rows, number == 0u);
}

// Where the vertex stands in the patch's ring that a stencil is relative to. A quad's corners come first there, in the plan's order.
uint origin_place(Patch record, Ring ring, uint corner) {
    if (!ring.inside) return place_at(ring.places, 0u);
    if (corner == STENCIL_OWN) return 0u;
    if ((record.flags & PATCH_HALF) == 0u) return corner - STENCIL_CORNER;
    return place_at(uses[use_of(record, use_of_corner(record, corner))].ring, 0u);
}

// A stencil's sum over a ring, relative to a vertex near it: so it errs by what the ring's own size has for rounding.
//
// Rings too long for the vertex shader are also too long for a plain sum: where hundreds of faces meet, the tangents of neighbours differ by
// less than it would lose.
vec3 stencil_point(Patch record, Ring ring, uint number) {
    StencilRow row = stencil_row(ring.rows + number, ring.size);
    vec3 origin = ring_point(record, origin_place(record, ring, row.corner));
    precise vec3 sum = vec3(0.0);
    vec3 lost = vec3(0.0);
    // Two terms at a time, whose places are in one word.
    for (uint i = 0u; i < ring.size; i += 2u) {
        uint places = control_at(ring.places + i / PLACES_A_WORD) >> BITS_A_PLACE * (i % PLACES_A_WORD);
        uint place = first_place(places);
        precise vec3 term = weight_at(row, ring.inside ? place : i) * ring_spoke(record, place, origin);
        add_term(sum, lost, term, ring.size);
        if (i + 1u < ring.size) {
            place = first_place(places >> BITS_A_PLACE);
            term = weight_at(row, ring.inside ? place : i + 1u) * ring_spoke(record, place, origin);
            add_term(sum, lost, term, ring.size);
        }
    }
    return sum;
}

// What a corner is evaluated by: the limit position, relative to the first vertex of the ring, and a pair of tangents.
struct Limit {
    vec3 position;
    Tangents tangents;
};

// The sums of three dense rows over a ring.
Limit ring_limit(Patch record, Ring ring, uvec3 numbers) {
    uint at = dense_row(ring.rows + numbers.x);
    uint at_u = dense_row(ring.rows + numbers.y);
    uint at_v = dense_row(ring.rows + numbers.z);
    vec3 origin = ring_point(record, ring.inside ? 0u : place_at(ring.places, 0u));
    precise vec3 sum = vec3(0.0);
    vec3 du = vec3(0.0);
    vec3 dv = vec3(0.0);
    vec3 lost = vec3(0.0);
    vec3 lost_u = vec3(0.0);
    vec3 lost_v = vec3(0.0);
    precise vec2 spread = vec2(0.0);
    precise vec2 total = vec2(0.0);
    for (uint i = 0u; i < ring.size; ++i) {
        precise vec3 spoke = ring_spoke(record, ring.inside ? i : place_at(ring.places, i), origin);
        vec2 pair = vec2(weights[at_u + i], weights[at_v + i]);
        precise vec3 along_u = pair.x * spoke;
        precise vec3 along_v = pair.y * spoke;
        add_compensated(du, lost_u, along_u);
        add_compensated(dv, lost_v, along_v);
        spread += abs(pair) * reach(spoke);
        total += abs(pair);
        precise vec3 term = weights[at + i] * spoke;
        add_term(sum, lost, term, ring.size);
    }
    return Limit(sum, Tangents(du, dv, rounding_errors(spread, total, origin)));
}

// The limit position, relative to the first vertex of the corner's ring, and the normal at the patch's corner that is use `number`. They depend on nothing but
// what all who share the corner have; at cusps, and between two sharp edges of a single face, the normal depends on the face.
//
// There are two pairs of tangents at most, the limit's and those that may stand in for it; the loop makes them one piece of code.
Point corner_point(Patch record, uint number) {
    uint flags = uses[use_of(record, number)].flags;
    uint near_pair = uses[use_of(record, number)].root;
#ifdef LONG_RINGS
    // All of it is there; the loop below has nothing to do.
    bool is_hub = (flags & USE_HUB) != 0u;
#else
    const bool is_hub = false;
#endif
    bool has_near = near_pair != NO_TANGENTS && !is_hub;
    bool is_cusp = (flags & USE_CUSP) != 0u;
    uint limit_pair = 1u + 2u * (flags >> USE_SIDE_SHIFT);
    uint pairs = is_hub ? 0u : has_near || (flags & USE_SPARE) != 0u ? 2u : 1u;
    Limit limit;
    vec3 limit_normal = vec3(0.0);
    vec3 normal = vec3(0.0);
    for (uint i = 0u; i < pairs; ++i) {
        Ring ring = use_ring(record, i == 1u && has_near ? 0u : number, 3u);
        uint pair = i == 0u ? limit_pair : has_near ? near_pair : limit_pair + 2u;
        // At a cusp there is no limit's pair.
        uvec3 rows = i == 0u ? is_cusp ? uvec3(0u) : uvec3(0u, pair, pair + 1u) : uvec3(pair, pair, pair + 1u);
        Limit sums = ring_limit(record, ring, rows);
        normal = clear_normal(sums.tangents);
        // The plan's tangents go the other way round there.
        if (i == 1u && has_near && is_mirrored(record)) normal = -normal;
        if (i == 0u) {
            limit = sums;
            limit_normal = normal;
        }
    }
    if (!is_cusp) {
        if (has_near) {
            normal = normal_of_single(limit.tangents, limit_normal, normal);
        } else if (limit_normal != vec3(0.0)) {
            normal = limit_normal;
        }
    }
#ifdef LONG_RINGS
    if (is_hub) {
        uint used = use_of(record, number);
        vec3 origin = ring_point(record, place_at(uses[used].ring, 0u));
        return Point(hub_spoke(uses[used].rows, origin), hub_point(uses[used].root).normal);
    }
#endif
    return Point(limit.position, normal);
}

#ifdef STAGE_CONTROL
// Where the points of a use end in the slot, and where the slot does.
uint ends_of(Patch record) { return bases.own[6] + borders[border_of(record)].ends; }
uint scratch_points(Patch record, uint level) { return ends[ends_of(record)].levels[min(level, HIGHEST_LEVEL)][(USES - 1u) >> 1u] & 0xffffu; }

// The parts of a slot: the heads, the plain vertices from USES on, the points of each use's plan.
struct Parts {
    uint plain_end;
    uint ends[USES];
};

Parts find_parts(Patch record, uint level) {
    Parts parts;
    parts.plain_end = USES + borders[border_of(record)].plain_count;
    uint first = ends_of(record);
    for (uint number = 0u; number < USES; number += 2u) {
        uint pair = ends[first].levels[min(level, HIGHEST_LEVEL)][number >> 1u];
        parts.ends[number] = pair & 0xffffu;
        if (number + 1u < USES) parts.ends[number + 1u] = pair >> 16u;
    }
    return parts;
}

// A stretch of the slot: the points of one use.
struct Part {
    uint number;
    uint start;
    uint end;
};

// The part, of the inside or an edge, that point `next` is in.
Part find_part(Parts parts, uint next) {
    Part part = Part(0u, parts.plain_end, parts.ends[0]);
    for (uint i = 1u; i < 5u; ++i) {
        bool beyond = next >= parts.ends[i - 1u];
        part.number = beyond ? i : part.number;
        part.start = beyond ? parts.ends[i - 1u] : part.start;
        part.end = beyond ? parts.ends[i] : part.end;
    }
    return part;
}

// The head of use `number`.
vec4 use_head(Patch record, Parts parts, uint number) {
    uint used = use_of(record, number);
    bool planned = uses[used].size > 0u;
    bool inside = (uses[used].flags & USE_INSIDE) != 0u;
    uint first = number == 0u ? 0u : place_at(uses[used].ring, 0u);
    uint start = parts.plain_end;
    for (uint i = 1u; i < USES; ++i) start = number == i && !inside ? parts.ends[i - 1u] : start;
    vec3 origin = planned || number >= STENCIL_CORNER ? ring_point(record, first) : vec3(0.0);
    return vec4(origin, float(planned || inside ? start : USES));
}

// How many invocations a patch has, no less than eight: as many as the device runs abreast, for with more of them it would go again through all that is done once a
// patch. The pipeline says so, and the module's `OutputVertices` with it (`gpu::shaders::invocations`).
layout(constant_id = CONSTANT_ID_INVOCATIONS) const uint INVOCATIONS = CONTROL_INVOCATIONS;

// Fills the slot: each point is one invocation's. Those of the inside and of edges are one stretch, so that few invocations have nothing to do; corners,
// where tangents are summed and normals decided, are another.
//
// Machines that run invocations abreast go through all code that one of them needs, and through the body of a loop once more to find out at its
// beginning that they are done: therefore these loops are tested at their ends. Those that compute something must not be: what an invocation has
// computed when it leaves such a loop before others do is overwritten by theirs (seen on llvmpipe, Mesa 22.3.6).
void run_stencils(Patch record, uint slot, uint level, uint count) {
    Parts parts = find_parts(record, level);
    uint next = gl_InvocationID;
    if (count > 0u && next < USES) do {
        scratch[slot + next] = use_head(record, parts, next);
        next += INVOCATIONS;
    } while (next < USES);
    next = USES + gl_InvocationID;
    uint end = min(parts.plain_end, count);
    if (next < end) do {
        scratch[slot + next].xyz = ring_point(record, place_at(borders[border_of(record)].plain, next - USES));
        next += INVOCATIONS;
    } while (next < end);
    next = parts.plain_end + gl_InvocationID;
    end = min(parts.ends[4], count);
    if (next < end) do {
        Part part = find_part(parts, next);
        Ring ring = use_ring(record, part.number, min(part.end - part.start, count));
        scratch[slot + next].xyz = stencil_point(record, ring, next - part.start);
        next += INVOCATIONS;
    } while (next < end);
    uint number = min(5u + gl_InvocationID, USES - 1u);
    uint place = parts.ends[number - 1u];
    if (5u + gl_InvocationID < USES && place + 1u < min(parts.ends[number], count)) {
        Point point = corner_point(record, number);
        scratch[slot + place].xyz = point.position;
        scratch[slot + place + 1u].xyz = point.normal;
    }
}
#else
// The point that a job is for.
vec3 job_point(uvec2 job) {
    Patch record = patches[job.x];
    uint kind = job.y >> JOB_KIND_SHIFT;
    uint number = min(job.y >> JOB_USE_SHIFT & 15u, USES - 1u);
    uint row = job.y & 0xffffu;
    if (kind == JOB_VERTEX) return ring_point(record, row);
    if (kind == JOB_LIMIT || kind == JOB_NORMAL) {
        Point corner = corner_point(record, number);
        return kind == JOB_LIMIT ? corner.position : corner.normal;
    }
    return stencil_point(record, use_ring(record, number, row + 1u), row);
}
#endif
#endif

#ifdef STAGE_EVALUATION
// Where the points of a leaf's row are. Corners have two points, and go the way of all others: machines that run invocations abreast would go both.
uvec4 row_places(uint first, bool corner, uint number) { return first + (corner ? uvec4(0u, 1u, 1u, 1u) : node_row(number)); }

Row scratch_row(uvec4 row, Basis u) {
    return bspline_row(u, point_at(row.x), point_at(row.y), point_at(row.z), point_at(row.w));
}

// Not on infinite creases and at cusps.
bool has_one_normal(Patch record, vec2 uv) {
    return (uses[use_of(record, find_place(record.flags, uv).number)].flags & USE_CREASED) == 0u;
}

// Row 1 is the position on an edge, row 2 that plus the derivative across.
const Basis CURVE = Basis(vec4(0.0, 1.0, 0.0, 0.0), vec4(0.0, -1.0, 1.0, 0.0));

// A point with its tangents, where it has some.
struct Evaluated {
    Point point;
    vec3 du;
    vec3 dv;
};

// Inside by the patch's own plan, on edges and at corners by those that all faces there share; on an edge that both sides evaluate alike, by its own again.
Evaluated evaluate_place(Patch record, uint slot, vec2 uv) {
    Place place = find_place(record.flags, uv);
    uint used = use_of(record, place.number);
    uint flags = uses[used].flags;
    uint first = use_points(slot, place.number);
    bool corner = (flags & USE_LIMIT) != 0u;
    bool exchanged = place.number == 0u && is_mirrored(record);
    vec2 local = exchanged ? uv.yx : place.number == 0u ? uv : vec2(place.number < 5u ? on_edge(flags, place.along) : 0.0, 0.0);
    Leaf leaf = find_leaf(corner ? 0u : uses[used].root, local);
    Basis u, v;
    creased_bases(leaf.uv, leaf.edge, leaf.sharpness, u, v);
    if (leaf.kind == NODE_CURVE) v = CURVE;
    uint row = leaf.points + 16u * (flags >> USE_SIDE_SHIFT);
    uvec4 lowest = row_places(first, corner, row);
    vec3 limit = point_at(lowest.x);
    vec3 limit_normal = point_at(lowest.y);
    Surface surface = bspline_surface(v, leaf.scale, bspline_row(u, limit, limit_normal, point_at(lowest.z), point_at(lowest.w)),
                                      scratch_row(row_places(first, corner, row + 4u), u),
                                      scratch_row(row_places(first, corner, row + 8u), u),
                                      scratch_row(row_places(first, corner, row + 12u), u));
    if ((flags & USE_REFLECTED) != 0u) surface.du = -surface.du;
    surface = exchanged ? Surface(surface.position, surface.dv, surface.du) : turned(surface, flags >> USE_TURN_SHIFT & 3u);
    // Half of the edge is the whole patch.
    float scale = (flags & (USE_FIRST_HALF | USE_SECOND_HALF)) != 0u ? 0.5 : 1.0;
    vec3 base = leaf.base > 0u && !corner ? point_at(first + max(leaf.base, 1u) - 1u) : vec3(0.0);
    uint origin_kind = corner ? 0u : leaf.origin;
    uint origin_use = origin_kind > 0u ? use_of_corner(record, origin_kind) : place.number;
    vec3 origin = origin_kind == ORIGIN_NONE ? vec3(0.0) : use_origin(slot, origin_use);
    precise vec3 vertex = limit + origin;
    if (corner) return Evaluated(Point(vertex, limit_normal), vec3(0.0), vec3(0.0));
    precise vec3 position = (surface.position + base) + origin;
    precise vec3 du = scale * surface.du;
    precise vec3 dv = scale * surface.dv;
    return Evaluated(Point(position, surface_normal(Surface(position, du, dv))), du, dv);
}

// A corner has the limit and its normal, and no tangents: differences along both edges stand for them, to second order, in the limit's plane. At an
// extraordinary vertex, where only their directions have a limit, their lengths depend on how far they reach: to the first two vertices of the level.
void corner_tangents(Patch record, uint slot, vec2 uv, Point corner, out vec3 du, out vec3 dv) {
    float nearest = power_of_two(-int(tangent_level));
    bool chords = tangent_level == 0u;
    du = vec3(0.0);
    dv = vec3(0.0);
    for (uint i = 0u; i < 4u; ++i) {
        bool by_u = (i & 1u) == 0u;
        bool twice = i >= 2u;
        precise float step = (twice && !chords ? 2.0 * nearest : nearest) * ((by_u ? uv.x : uv.y) > 0.5 ? -1.0 : 1.0);
        precise vec2 at = by_u ? vec2(uv.x + step, uv.y) : vec2(uv.x, uv.y + step);
        float weight = chords ? 0.5 : twice ? -1.0 : 2.0;
        precise vec3 slope = (weight / step) * (evaluate_place(record, slot, at).point.position - corner.position);
        du += by_u ? slope : vec3(0.0);
        dv += by_u ? vec3(0.0) : slope;
    }
    du -= dot(du, corner.normal) * corner.normal;
    dv -= dot(dv, corner.normal) * corner.normal;
}

Point evaluate_patch(Patch record, uint slot, vec2 uv) {
#ifndef CACHED_POINTS
    memoryBarrierBuffer();
#endif
    Evaluated own = evaluate_place(record, slot, uv);
    if (TANGENTS) {
        vec3 du = own.du;
        vec3 dv = own.dv;
        bool corner = (uses[use_of(record, find_place(record.flags, uv).number)].flags & USE_LIMIT) != 0u;
        if (corner) corner_tangents(record, slot, uv, own.point, du, dv);
        keep_tangents(du, dv);
    }
    return own.point;
}
#endif

#ifdef STAGE_FRAGMENT
Cell cell_at(Patch record, vec2 uv) {
    bool mirrored = is_mirrored(record);
    Leaf leaf = find_leaf(uses[use_of(record, 0u)].root, mirrored ? uv.yx : uv);
    return Cell(leaf.kind, mirrored ? leaf.uv.yx : leaf.uv, leaf.scale);
}
#endif

#endif
