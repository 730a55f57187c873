// The vertices of a section before the eye, beside those of all other sections: so that one kernel can draw segments of all of
// them. One thread a vertex.

import package::grid::{GROUP, thread_index};
import package::ribbon::is_sound;
import package::strands::{colors, end_at, positions, section};

@group(0) @binding(6) var<storage, read_write> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> paints: array<vec2<u32>>;

// A point that nothing is drawn from.
const NOWHERE: vec4<f32> = vec4(3e38, 3e38, 3e38, 0.0);

@compute @workgroup_size(GROUP)
fn tile_points(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if i >= section.strands * section.vertices {
        return;
    }
    let end = end_at(i % section.strands, i / section.strands);
    points[i] = select(NOWHERE, vec4(end.point, end.radius), is_sound(positions[i].xyz));
    paints[i] = colors[i];
}
