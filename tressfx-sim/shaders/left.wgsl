// What the elimination leaves of an edge for the sweep back. Two matrices are stored in 16 bits a number: what is lost of them is lost of a step of
// Newton's method, one part in 2,000 of each of its terms, and the next round or sub-step makes up for it.

import package::rod::{LEFT, Strand, rods, slot};

/// The rotation of the edge is `free + turn - behind * turn - by_place * shift / scale`, with the rotation of its parent, the displacement of the
/// vertex before it, and `scale_of` its length.
struct Left {
    free: vec3<f32>,
    /// By how much it stays behind its parent.
    behind: mat3x3<f32>,
    by_place: mat3x3<f32>,
}

/// So `by_place` has about what `behind` has: at most some thousands, the root of what `LEAST_TWIST` and `LEAST_PIVOT` leave between the stiffest
/// direction and the softest. 16 bits go to 65,504; what is more, as in strands of kilometres that bend within millimetres, is cut off there.
fn scale_of(strand: Strand, length: f32) -> f32 {
    return max(length, strand.shortest_span);
}

/// As it is stored: a column of both matrices and a component of `free` each.
struct Packed { first: vec4<f32>, second: vec4<f32>, third: vec4<f32> }

fn packed_left(strand: Strand, vertex: u32) -> Packed {
    return Packed(rods[slot(strand, vertex, LEFT)], rods[slot(strand, vertex, LEFT + 1u)], rods[slot(strand, vertex, LEFT + 2u)]);
}

fn store_left(strand: Strand, vertex: u32, left: Left) {
    rods[slot(strand, vertex, LEFT)] = vec4(paired(left.by_place[0], left.behind[0]), left.free.x);
    rods[slot(strand, vertex, LEFT + 1u)] = vec4(paired(left.by_place[1], left.behind[1]), left.free.y);
    rods[slot(strand, vertex, LEFT + 2u)] = vec4(paired(left.by_place[2], left.behind[2]), left.free.z);
}

fn left_of(packed: Packed) -> Left {
    let first = unpaired(packed.first.xyz);
    let second = unpaired(packed.second.xyz);
    let third = unpaired(packed.third.xyz);
    let free = vec3(packed.first.w, packed.second.w, packed.third.w);
    return Left(free, mat3x3(first.b, second.b, third.b), mat3x3(first.a, second.a, third.a));
}

struct Pair { a: vec3<f32>, b: vec3<f32> }

/// Added to the bits of a pair, this keeps it from being a subnormal number, which WGSL allows to become 0 on its way through `f32`. The second of a pair is
/// less than 61,440, or it would become none that is finite.
const NORMAL: u32 = 0x04000000u;

/// More would be infinite.
const LARGEST: vec3<f32> = vec3(60000.0);

/// A component of both in each of three numbers.
fn paired(first: vec3<f32>, second: vec3<f32>) -> vec3<f32> {
    let a = clamp(first, -LARGEST, LARGEST);
    let b = clamp(second, -LARGEST, LARGEST);
    let x = pack2x16float(vec2(a.x, b.x));
    let y = pack2x16float(vec2(a.y, b.y));
    let z = pack2x16float(vec2(a.z, b.z));
    return bitcast<vec3<f32>>(vec3(x, y, z) + NORMAL);
}

fn unpaired(pairs: vec3<f32>) -> Pair {
    let bits = bitcast<vec3<u32>>(pairs) - NORMAL;
    let x = unpack2x16float(bits.x);
    let y = unpack2x16float(bits.y);
    let z = unpack2x16float(bits.z);
    return Pair(vec3(x.x, y.x, z.x), vec3(x.y, y.y, z.y));
}
