// The box of the hair in each frame. One thread for eight vertices of a strand, of an even sample.

import package::frames::{ShadowUniform, in_frame, order_of};
import package::grid::{GROUP, thread_index};
import package::ribbon::is_sound;
import package::section::{SectionUniform, moved_aside, source_of, stepped};

@group(0) @binding(0) var<uniform> shadow: ShadowUniform;
@group(0) @binding(1) var<uniform> section: SectionUniform;
@group(0) @binding(2) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> bounds: array<atomic<u32>>;

// Vertices of a thread: fewer threads wait longer for their bytes, and more of them take turns at the box.
const PIECE: u32 = 8u;
// Six of the box in each of nine frames.
const SIDES: u32 = 54u;

// The boxes of the strands of the group: the largest of x, y, z and of -x, -y, -z, as whole numbers in their order.
var<workgroup> boxes: array<atomic<u32>, SIDES>;

fn note(at: u32, value: f32) {
    // Most change nothing, and need no turn.
    if order_of(value) > atomicLoad(&boxes[at]) {
        atomicMax(&boxes[at], order_of(value));
    }
}

fn note_box(frame: u32, low: vec3<f32>, high: vec3<f32>) {
    for (var axis = 0u; axis < 3u; axis++) {
        note(6u * frame + axis, high[axis]);
        note(6u * frame + 3u + axis, -low[axis]);
    }
}

// The boxes of some vertices of a strand.
fn note_piece(strand: u32, first: u32, end: u32) {
    let source = source_of(section.strands, strand);
    let aside = moved_aside(section.strands, section.copy_spread, strand);
    for (var frame = shadow.first; frame < shadow.end; frame++) {
        var low = vec3(3e38);
        var high = vec3(-3e38);
        for (var vertex = first; vertex < end; vertex++) {
            let local = positions[stepped(section.lod, vertex, section.vertices) * section.strands + source].xyz;
            if is_sound(local) {
                let at = in_frame(shadow.frames[frame], (section.pose * vec4(local + aside, 1.0)).xyz);
                low = min(low, at);
                high = max(high, at);
            }
        }
        if low.x <= high.x {
            note_box(frame, low, high);
        }
    }
}

@compute @workgroup_size(GROUP)
fn shadow_bounds(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                 @builtin(local_invocation_index) lane: u32) {
    if lane < SIDES {
        atomicStore(&boxes[lane], 0u);
    }
    workgroupBarrier();
    let i = thread_index(group, groups, lane);
    let samples = min(section.shadow_strands, shadow.samples);
    let first = i / samples * PIECE;
    note_piece(i % samples, first, min(first + PIECE, section.lod.vertices));
    workgroupBarrier();
    // One turn of a group at each side, where each strand would take one.
    if lane < SIDES {
        let order = atomicLoad(&boxes[lane]);
        if order > atomicLoad(&bounds[lane]) {
            atomicMax(&bounds[lane], order);
        }
    }
}
