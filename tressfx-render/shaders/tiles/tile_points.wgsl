// What may be seen of a section on the screen: the vertices of its segments, behind those of the sections before, so that one kernel can
// draw segments of all of them. Segments outside of the picture, and those behind the opaque scene in all tiles that they may touch, are
// left out. Also the nearest vertex of each tile. One thread a vertex; a group has a piece of each of several strands, the one of its plane.

import package::joint::{ROUND, tilt_of};
import package::points::{ANYWHERE, NOWHERE, SOMEWHERE, point_of, reach_between};
import package::ribbon::is_sound;
import package::screen::{tile_columns, view};
import package::segments::{Vertex, pack_rest};
import package::strands::{Strand, bend_at, colors, end_at, is_sound_at, neighbours_of, section, strand_at, tilt_between, vertex_of};
import package::tile::TILE;
import package::tiles::{SharedTileInfo, ViewState, tiles};

@group(0) @binding(6) var<storage, read_write> vertices: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read_write> paints: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read_write> state: ViewState;
@group(0) @binding(9) var<storage, read_write> infos: array<SharedTileInfo>;

const LANES: u32 = 256u;
// Strands of a group: those whose pieces have two vertices.
const MOST_STRANDS: u32 = LANES / 2u;
// The nearest vertex of a tile is looked for among so many vertices of a section, and in one run of lanes of MOST_BETWEEN at least: it decides about speed
// alone. Hair before the vertex that is found is all in the first slice; where a strand lies alone before the others, it takes the thin slices from them.
const SAMPLES: u32 = 131072u;
const MOST_BETWEEN: u32 = 8u;
// Lanes beside each other, which a GPU has at work together: those that look make no others wait.
const RUN: u32 = LANES / MOST_BETWEEN;

// The points of the group: a vertex of each strand, then the next ones.
var<workgroup> points: array<vec4<f32>, LANES>;
// Of each strand, a bit for each segment that may be seen.
var<workgroup> seen: array<atomic<u32>, MOST_STRANDS>;
// Vertices of all strands before that are kept, and where the first of all is.
var<workgroup> starts: array<u32, MOST_STRANDS>;
var<workgroup> first_place: u32;

// How strands are cut into pieces, all alike: a piece ends with the vertex that the next one begins with. It has at most 31 segments: a bit each, and
// one for the vertex at its end.
struct Pieces {
    // Of a piece.
    segments: u32,
    // Of a group.
    strands: u32,
}

// A quotient of whole numbers below 1024. It is exact: with the half, it is at least 1/2048 away from a whole number, and off by less than 3e-4.
fn quotient(number: u32, divisor: u32) -> u32 {
    return u32((f32(number) + 0.5) / f32(divisor));
}

// Where a strand has so many.
fn pieces(count: u32) -> Pieces {
    let segments = quotient(section.lod.vertices + count - 2u, count);
    return Pieces(segments, quotient(LANES, segments + 1u));
}

// Whether a lane of a group looks for the nearest vertices of tiles.
fn looks(group: u32, lane: u32) -> bool {
    let between = 1u << firstLeadingBit(clamp(section.lod.strands * section.lod.vertices / SAMPLES, 1u, MOST_BETWEEN));
    return ((lane / RUN - group) & (between - 1u)) == 0u;
}

fn screen_point(strand: Strand, vertex: u32) -> vec4<f32> {
    if !is_sound_at(strand, vertex) {
        return NOWHERE;
    }
    return point_of(end_at(strand, vertex));
}

// How the strand goes on at a vertex of a lane. Where the group has the vertices before and after it, their pixels are known.
fn tilt_at(strand: Strand, vertex: u32, own_vertex: u32, lane: u32, pieces: Pieces) -> f32 {
    if vertex == 0u || vertex + 1u == section.lod.vertices {
        return ROUND;
    }
    if own_vertex > 0u && own_vertex < pieces.segments {
        let before = points[lane - pieces.strands];
        let middle = points[lane];
        let after = points[lane + pieces.strands];
        if is_sound(before.xyz) && is_sound(after.xyz) && min(min(before.w, middle.w), after.w) >= 0.0 {
            return tilt_of(middle.xy - before.xy, after.xy - middle.xy);
        }
    }
    let beside = neighbours_of(strand, vertex);
    return select(tilt_between(bend_at(strand, vertex, beside)), ROUND, any(beside == vec2(vertex)));
}

fn store(place: u32, strand: Strand, vertex: u32, point: vec4<f32>, tilt: f32, paint: vec2<u32>, leads_on: bool) {
    let rest = pack_rest(Vertex(point.xyz, abs(point.w), tilt, point.w < 0.0, leads_on));
    vertices[place] = vec4(bitcast<vec3<u32>>(point.xyz), rest);
    paints[place] = paint;
}

fn note_nearest(point: vec4<f32>) {
    if point.w < 0.0 || any(point.xy < vec2(0.0)) || any(point.xy >= vec2<f32>(view.size)) || point.z <= 0.0 {
        return;
    }
    let tile = vec2<u32>(point.xy) / TILE;
    let place = tile.y * tile_columns() + tile.x;
    // Numbers that are not negative are in the order of their bits.
    let bits = bitcast<u32>(point.z);
    // Most vertices are not the nearest, and need no turn at the counter.
    if bits > atomicLoad(&infos[place].nearest) {
        atomicMax(&infos[place].nearest, bits);
    }
}

// Whether the opaque scene shows something at a nearness in any of these tiles. Four are looked at together, along the longer side: a lane
// that looks at one after the other waits for each.
fn is_before_scene(nearest: f32, low: vec2<i32>, high: vec2<i32>) -> bool {
    let columns = i32(tile_columns());
    let size = high - low;
    let is_wide = size.x >= size.y;
    let along = select(columns, 1, is_wide);
    let across = select(1, columns, is_wide);
    let long = max(size.x, size.y);
    let short = min(size.x, size.y);
    let first = low.y * columns + low.x;
    for (var row = 0; row <= short; row++) {
        for (var next = 0; next <= long; next += 4) {
            let places = first + row * across + min(vec4(next) + vec4(0, 1, 2, 3), vec4(long)) * along;
            let scene = vec4(infos[places.x].scene, infos[places.y].scene, infos[places.z].scene, infos[places.w].scene);
            if any(vec4(nearest) >= scene) {
                return true;
            }
        }
    }
    return false;
}

// Whether a segment may be seen.
fn may_be_seen(a: vec4<f32>, b: vec4<f32>) -> bool {
    let reach = reach_between(a, b);
    if reach.place != SOMEWHERE {
        return reach.place == ANYWHERE;
    }
    return is_before_scene(reach.nearest, reach.low, reach.high);
}

// The vertices of segments that may be seen, a bit each.
fn kept_of(own: u32) -> u32 {
    let segments = atomicLoad(&seen[own]);
    return segments | (segments << 1u);
}

// Finds places for what is kept of all strands of the group. All lanes come here.
fn place_all(strands: u32, lane: u32) {
    if lane < strands {
        var sum = 0u;
        for (var i = 0u; i < lane; i++) {
            sum += countOneBits(kept_of(i));
        }
        starts[lane] = sum;
    }
    workgroupBarrier();
    if lane == 0u {
        first_place = atomicAdd(&state.counters.vertices, starts[strands - 1u] + countOneBits(kept_of(strands - 1u)));
    }
    workgroupBarrier();
}

@compute @workgroup_size(LANES)
fn tile_points(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let pieces = pieces(groups.z);
    let index = group.y * groups.x + group.x;
    let own_vertex = quotient(lane, pieces.strands);
    let own = lane - own_vertex * pieces.strands;
    let number = index * pieces.strands + own;
    let strand = strand_at(number);
    let vertex = group.z * pieces.segments + own_vertex;
    let exists = own_vertex <= pieces.segments && number < section.lod.strands && vertex < section.lod.vertices;
    var point = NOWHERE;
    var paint: vec2<u32>;
    if exists {
        // Read before it is known whether the vertex is kept: later, all of the group would wait for it.
        paint = colors[vertex_of(strand, vertex)];
        point = screen_point(strand, vertex);
        if looks(index, lane) && is_sound(point.xyz) {
            note_nearest(point);
        }
    }
    points[lane] = point;
    if lane < pieces.strands {
        atomicStore(&seen[lane], 0u);
    }
    workgroupBarrier();
    if exists && own_vertex < pieces.segments && may_be_seen(point, points[lane + pieces.strands]) {
        atomicOr(&seen[own], 1u << own_vertex);
    }
    workgroupBarrier();
    place_all(pieces.strands, lane);
    let kept = kept_of(own);
    if !exists || ((kept >> own_vertex) & 1u) == 0u {
        return;
    }
    let place = first_place + starts[own] + countOneBits(kept & ((1u << own_vertex) - 1u));
    let is_seen = ((atomicLoad(&seen[own]) >> own_vertex) & 1u) == 1u;
    let leads_on = is_seen && place + 1u < tiles.vertices;
    if place < tiles.vertices {
        store(place, strand, vertex, point, tilt_at(strand, vertex, own_vertex, lane, pieces), paint, leads_on);
    }
    if is_seen != leads_on {
        atomicAdd(&state.counters.dropped, 1u);
    }
}
