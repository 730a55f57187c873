// The walk of a segment over the pixels that it covers. Data-centre GPUs have few raster units, and hair is thinner than
// the triangles that they were made for: so the segment finds its own pixels. What becomes of a fragment is up to the
// technique: it brings a module `sink` with a struct `Sink` and a function `take(sink, pixel, fragment)`.

import package::listed::{NO_SEGMENT, segment_of};
import package::line::{Line, Paint, Span, fragment_at, has_ends_of, is_drawn, line_of, middle_of, span_of};
import package::ribbon::{Ribbon, slant_of};
import package::screen::view;
import package::sink::{Sink, take};
import package::strands::{paint_of, ribbon_of, section, strand_at};

// Visits the pixels that the ribbon may touch. Where it has ends a fragment is more work. A CPU takes all lanes through both sides of a branch, but
// leaves a loop that no lane is in: there ribbons with ends have a loop of their own.
fn walk(ribbon: Ribbon, paint: Paint, sink: ptr<function, Sink>) {
    let line = line_of(ribbon);
    if !is_drawn(ribbon, line) {
        return;
    }
    let span = span_of(ribbon, line);
    let has_ends = has_ends_of(ribbon);
    @if(ends_apart) {
        visit(ribbon, line, paint, span_if(!has_ends, span), false, sink);
        visit(ribbon, line, paint, span_if(has_ends, span), true, sink);
    }
    @if(!ends_apart) { visit(ribbon, line, paint, span, has_ends, sink); }
}

@if(ends_apart)
fn span_if(is_visited: bool, span: Span) -> Span {
    var visited = span;
    visited.last_column = select(-1, span.last_column, is_visited);
    return visited;
}

// Column by column along the axis that the ribbon follows most. In one loop, so that no lane waits at the end of a column for those with more rows.
fn visit(ribbon: Ribbon, line: Line, paint: Paint, span: Span, has_ends: bool, sink: ptr<function, Sink>) {
    let slant = slant_of(view.lens, ribbon);
    var column = span.first_column - 1;
    var row = 0;
    var last_row = -1;
    loop {
        if row >= last_row {
            column++;
            let middle = middle_of(span, column);
            last_row = min(i32(floor(middle + span.half_height)), span.size.y - 1);
            row = max(i32(ceil(middle - span.half_height)), 0) - 1;
        }
        if column > span.last_column {
            break;
        }
        row++;
        if row <= last_row {
            let pixel = vec2<u32>(select(vec2(column, row), vec2(row, column), span.steep));
            let fragment = fragment_at(ribbon, line, slant, paint, pixel, has_ends);
            if fragment.alpha > 0u {
                take(sink, pixel, fragment);
            }
        }
    }
}

// Visits those of the segment of a thread, if it has one.
fn walk_segment(thread: u32, sink: ptr<function, Sink>) {
    let segment = segment_of(thread);
    if segment != NO_SEGMENT {
        let strand = strand_at(segment % section.lod.strands);
        let vertex = segment / section.lod.strands;
        walk(ribbon_of(strand, vertex), paint_of(strand, vertex), sink);
    }
}
