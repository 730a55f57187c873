// The walk of a segment over the pixels that it covers. Data-centre GPUs have few raster units, and hair is thinner than
// the triangles that they were made for: so the segment finds its own pixels. What becomes of a fragment is up to the
// technique: it brings a module `sink` with a struct `Sink` and a function `take(sink, pixel, fragment)`.

import package::line::{Paint, fragment_at, is_drawn, line_of, middle_of, span_of};
import package::ribbon::Ribbon;
import package::sink::{Sink, take};
import package::strands::{paint_of, ribbon_of, section, strand_at};

// Visits the pixels that the ribbon may touch, column by column along the axis that it follows most.
fn walk(ribbon: Ribbon, paint: Paint, sink: ptr<function, Sink>) {
    let line = line_of(ribbon);
    if !is_drawn(ribbon, line) {
        return;
    }
    let span = span_of(ribbon, line);
    for (var column = span.first_column; column <= span.last_column; column++) {
        let middle = middle_of(span, column);
        let last_row = min(i32(floor(middle + span.half_height)), span.size.y - 1);
        for (var row = max(i32(ceil(middle - span.half_height)), 0); row <= last_row; row++) {
            let pixel = vec2<u32>(select(vec2(column, row), vec2(row, column), span.steep));
            let fragment = fragment_at(ribbon, line, paint, pixel);
            if fragment.alpha > 0u {
                take(sink, pixel, fragment);
            }
        }
    }
}

// Visits those of a segment of the section, if there are so many.
fn walk_segment(segment: u32, sink: ptr<function, Sink>) {
    if segment < section.lod.strands * (section.lod.vertices - 1u) {
        let strand = strand_at(segment % section.lod.strands);
        let vertex = segment / section.lod.strands;
        walk(ribbon_of(strand, vertex), paint_of(strand, vertex), sink);
    }
}
