// What `shortcut_depths` does, with the raster units.

import package::quad::{Corner, corner_of, fragment_of, pixel_of};
import package::sink::{Sink, count_fragments, take};

@vertex
fn segment_corner(@builtin(vertex_index) vertex: u32) -> Corner {
    return corner_of(vertex);
}

@fragment
fn shortcut_depths_raster(corner: Corner) -> @location(0) vec4<f32> {
    let fragment = fragment_of(corner);
    if fragment.alpha > 0u {
        var sink: Sink;
        take(&sink, pixel_of(corner), fragment);
        count_fragments(sink.count);
    }
    // The picture itself is drawn by the composite.
    discard;
    return vec4(0.0);
}
