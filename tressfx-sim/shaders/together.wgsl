// Threads of a group that go along a strand together; each group has some strands.

import package::constants::TOGETHER;

/// Threads of a group, of which a strand has `TOGETHER`.
const LANES: u32 = 32u;

/// Two vectors of an edge, or of all edges up to one.
struct Sums { a: vec3<f32>, b: vec3<f32> }

var<workgroup> sums: array<Sums, 2 * LANES>;
var<workgroup> wanted: array<u32, LANES>;
var<workgroup> is_wanted: u32;

/// Which thread of its strand a thread is. The first one does what is done in turn.
fn member(lane: u32) -> u32 {
    return lane % TOGETHER;
}

/// The sum of what this thread and those of its strand before it give (Hillis and Steele 1986). All threads of the group have to come here.
fn sum_up_to(lane: u32, own: Sums) -> Sums {
    var sum = own;
    var half = 0u;
    sums[lane] = sum;
    for (var reach = 1u; reach < TOGETHER; reach *= 2u) {
        workgroupBarrier();
        if (member(lane) >= reach) {
            let other = sums[half + lane - reach];
            sum = Sums(other.a + sum.a, other.b + sum.b);
        }
        half = LANES - half;
        sums[half + lane] = sum;
    }
    workgroupBarrier();
    return sum;
}

/// The sum of all threads of the strand, behind `sum_up_to`: it is in the second half, since threads of a strand are 2, 8 or 32, an odd power of two.
fn total(lane: u32) -> Sums {
    return sums[LANES + lane - member(lane) + TOGETHER - 1u];
}

/// The bits that any thread of the strand gives.
fn bits_of_strand(lane: u32, own: u32) -> u32 {
    wanted[lane] = own;
    workgroupBarrier();
    var bits = 0u;
    let first = lane - member(lane);
    for (var i = first; i < first + TOGETHER; i++) { bits |= wanted[i]; }
    workgroupBarrier();
    return bits;
}

/// Whether any strand of the group wants it: all threads of a strand have to say the same.
fn any_wants(lane: u32, wants: bool) -> bool {
    wanted[lane] = select(0u, 1u, wants);
    workgroupBarrier();
    if (lane == 0u) {
        var found = 0u;
        for (var i = 0u; i < LANES; i += TOGETHER) { found |= wanted[i]; }
        is_wanted = found;
    }
    return workgroupUniformLoad(&is_wanted) != 0u;
}
