// Strands between guides: along each of them the edges are a mean of those of three guides. One thread a strand, which goes from the root to the tip.

import package::grid::{GROUP, thread_index};
import package::hash::hash;
import package::vector::{across, direction_or};

struct Interpolation {
    /// Strands of the buffer that holds the guides, and vertices of each.
    guide_strands: u32,
    guide_vertices: u32,
    /// Strands of the buffers that are written, and vertices of each.
    strands: u32,
    vertices: u32,
    /// How many of the strands are written: the first ones.
    drawn: u32,
    /// How far tips are drawn to the nearest guide, and the power of the share of the strand with which that grows.
    clump: f32,
    clump_falloff: f32,
    /// By what share of its way from the root a vertex is moved aside, and how many times that changes along a strand.
    noise: f32,
    noise_waves: f32,
    padding_a: f32,
    padding_b: f32,
    padding_c: f32,
}

/// A strand and its guides, the nearest first.
struct BetweenGuides {
    guides: vec3<u32>,
    /// The share of the guides' length that it has.
    length: f32,
    /// What the second and the third guide have of its root; the first has the rest.
    root_shares: vec2<f32>,
    /// The same for its edges.
    edge_shares: vec2<f32>,
}

@group(0) @binding(0) var<uniform> interpolation: Interpolation;
@group(0) @binding(1) var<storage, read> guides: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> between_guides: array<BetweenGuides>;
@group(0) @binding(3) var<storage, read_write> positions: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> strand_tangents: array<vec4<f32>>;

/// The three guides at a vertex.
struct Trio { a: vec3<f32>, b: vec3<f32>, c: vec3<f32> }

/// The way along the vertices of the guides.
struct Walk {
    guides: Trio,
    /// Where the mean of their edges has come to, the direction of the last edge, and where the strand is.
    mean: vec3<f32>,
    direction: vec3<f32>,
    point: vec3<f32>,
    /// Where it would be without keeping its length.
    @if(clump) clumped: vec3<f32>,
}

/// Four points of a curve; it is drawn between the second and the third.
struct Piece { before: vec3<f32>, start: vec3<f32>, end: vec3<f32>, after: vec3<f32> }

@compute @workgroup_size(GROUP)
fn interpolate(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let index = thread_index(group, groups, lane);
    if (index >= interpolation.drawn) { return; }
    let strand = between_guides[index];
    var walk = begun(strand);
    var last = walk.point;
    var last_way = vec3(0.0, 1.0, 0.0);
    // Across the first edge, towards another guide's root, which the skin takes along.
    @if(noise) var side = walk.guides.b - walk.guides.a;
    @if(noise) var gone = 0.0;
    @if(spline) var number = 0u;
    @if(spline) var piece = first_piece(strand, &walk);
    @if(spline) let step = strand.length * f32(interpolation.guide_vertices - 1u) / f32(interpolation.vertices - 1u);

    @if(noise) var last_plain = last;
    positions[index] = vec4(last, 0.0);
    for (var vertex = 1u; vertex < interpolation.vertices; vertex++) {
        @if(!spline) { go_on(strand, vertex, &walk); }
        @if(!spline) var point = walk.point;
        @if(spline) let at = f32(vertex) * step;
        @if(spline) {
            while (f32(number + 1u) < at && number + 2u < interpolation.guide_vertices) {
                number++;
                piece = next_piece(piece, strand, number + 2u, &walk);
            }
        }
        @if(spline) var point = point_of(piece, at - f32(number));
        @if(noise) {
            let edge = point - last_plain;
            last_plain = point;
            gone += length(edge);
            let along = direction_or(edge, last_way);
            side = direction_or(side - along * dot(along, side), across(along));
            let aside = interpolation.noise * gone * noise_at(index, vertex);
            point += side * aside.x + cross(along, side) * aside.y;
        }
        let way = direction_or(point - last, last_way);
        var sum = way;
        if (vertex > 1u) { sum = direction_or(last_way + way, way); }
        strand_tangents[place(vertex - 1u, index)] = vec4(sum, 0.0);
        positions[place(vertex, index)] = vec4(point, 0.0);
        last = point;
        last_way = way;
    }
    strand_tangents[place(interpolation.vertices - 1u, index)] = vec4(last_way, 0.0);
}

fn place(vertex: u32, index: u32) -> u32 {
    return vertex * interpolation.strands + index;
}

fn trio_at(strand: BetweenGuides, vertex: u32) -> Trio {
    let places = vertex * interpolation.guide_strands + strand.guides;
    return Trio(guides[places.x].xyz, guides[places.y].xyz, guides[places.z].xyz);
}

/// At the root.
fn begun(strand: BetweenGuides) -> Walk {
    let roots = trio_at(strand, 0u);
    let root = roots.a + strand.root_shares.x * (roots.b - roots.a) + strand.root_shares.y * (roots.c - roots.a);
    @if(!clump) { return Walk(roots, root, vec3(0.0, 1.0, 0.0), root); }
    @if(clump) { return Walk(roots, root, vec3(0.0, 1.0, 0.0), root, root); }
}

/// To a vertex from the one before it. Guides that part have a mean edge that is shorter than theirs: it is given the mean of their lengths.
fn go_on(strand: BetweenGuides, vertex: u32, walk: ptr<function, Walk>) {
    let here = trio_at(strand, vertex);
    let a = here.a - (*walk).guides.a;
    let b = here.b - (*walk).guides.b;
    let c = here.c - (*walk).guides.c;
    (*walk).guides = here;
    let shares = vec3(1.0 - strand.edge_shares.x - strand.edge_shares.y, strand.edge_shares);
    let long = dot(shares, vec3(length(a), length(b), length(c)));
    let mean = shares.x * a + shares.y * b + shares.z * c;
    (*walk).direction = direction_or(mean, direction_or(a, (*walk).direction));
    (*walk).mean += (*walk).direction * long;
    @if(!clump) { (*walk).point = (*walk).mean; }
    @if(clump) {
        let share = f32(vertex) / f32(interpolation.guide_vertices - 1u);
        let clumped = mix((*walk).mean, here.a, interpolation.clump * pow(share, interpolation.clump_falloff));
        (*walk).point += direction_or(clumped - (*walk).clumped, (*walk).direction) * long;
        (*walk).clumped = clumped;
    }
}

/// From the root to the second vertex.
@if(spline)
fn first_piece(strand: BetweenGuides, walk: ptr<function, Walk>) -> Piece {
    let root = (*walk).point;
    go_on(strand, 1u, walk);
    let piece = Piece(root, root, root, (*walk).point);
    let begun = next_piece(piece, strand, 2u, walk);
    return Piece(2.0 * begun.start - begun.end, begun.start, begun.end, begun.after);
}

/// The piece behind this one; `vertex` is the one behind its end. Behind the tip a strand goes straight on.
@if(spline)
fn next_piece(piece: Piece, strand: BetweenGuides, vertex: u32, walk: ptr<function, Walk>) -> Piece {
    if (vertex >= interpolation.guide_vertices) {
        return Piece(piece.start, piece.end, piece.after, 2.0 * piece.after - piece.end);
    }
    go_on(strand, vertex, walk);
    return Piece(piece.start, piece.end, piece.after, (*walk).point);
}

/// The cubic curve through the points (Catmull and Rom 1974).
@if(spline)
fn point_of(piece: Piece, t: f32) -> vec3<f32> {
    let linear = piece.end - piece.before;
    let square = 2.0 * piece.before - 5.0 * piece.start + 4.0 * piece.end - piece.after;
    let cubic = 3.0 * (piece.start - piece.end) + piece.after - piece.before;
    return piece.start + 0.5 * t * (linear + t * (square + t * cubic));
}

/// A smooth curve through random numbers, from -1 to 1, one for each wave.
@if(noise)
fn noise_at(index: u32, vertex: u32) -> vec2<f32> {
    let at = interpolation.noise_waves * f32(vertex) / f32(interpolation.vertices - 1u);
    let wave = floor(at);
    let share = at - wave;
    return mix(random_at(index, u32(wave)), random_at(index, u32(wave) + 1u), share * share * (3.0 - 2.0 * share));
}

@if(noise)
fn random_at(index: u32, wave: u32) -> vec2<f32> {
    let seed = index * 512u + wave * 2u;
    return 2.0 * vec2(hash(seed), hash(seed + 1u)) - 1.0;
}
