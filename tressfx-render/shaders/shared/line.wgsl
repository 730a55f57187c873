// A ribbon on the pixels: the line through its middle, the pixels that it may touch, and what it leaves in one.

import package::coverage::{between, coverage, pixel_reach, rise_of};
import package::fragment::{Fragment, OPAQUE};
import package::joint::{ROUND, SHARP};
import package::ribbon::{Ribbon, along, slant_of};
import package::screen::{scene_nearness, view};

@if(places)
import package::places::stripe_of;

// Colour and opacity at the ends of a segment.
struct Paint {
    start: vec4<f32>,
    end: vec4<f32>,
}

// The surface may be of the segments before and behind, whose colours are not known here: up to this share of its length a segment goes on as
// it is.
const SURPLUS: f32 = 0.5;
// Half a width in pixels, and how high the surface of a fibre rises before its axis in the mean, in radii.
const THIN: f32 = 0.5;
const MEAN_RISE: f32 = 0.785398;
// The square of a length in pixels: a shorter segment has no direction.
const SHORTEST: f32 = 1e-12;
// The largest number below 1.
const LAST_PLACE: f32 = 0.99999994;
// Pixels by which a segment goes on behind its round end at a sharp turn: half the diagonal of a pixel, so that no pixel loses what it
// has of the strand behind the turn.
const ELBOW: f32 = 0.75;
// More than any segment has.
const ENDLESS: f32 = 1e6;

// The line through the middle of a ribbon, and what is the same in all of its pixels: not every compiler moves that out of a loop.
struct Line {
    delta: vec2<f32>,
    length: f32,
    // One over it.
    per_length: f32,
    normal: vec2<f32>,
    reach: vec2<f32>,
}

fn line_of(ribbon: Ribbon) -> Line {
    var delta = ribbon.end - ribbon.start;
    if dot(delta, delta) < SHORTEST {
        delta = vec2(sqrt(SHORTEST), 0.0);
    }
    let square = dot(delta, delta);
    let per_length = inverseSqrt(square);
    let direction = delta * per_length;
    let normal = vec2(-direction.y, direction.x);
    return Line(delta, sqrt(square), per_length, normal, pixel_reach(normal));
}

// A pixel beside a ribbon: how far along it from its start, and across.
fn beside(ribbon: Ribbon, line: Line, pixel: vec2<u32>) -> vec2<f32> {
    let offset = vec2<f32>(pixel) + 0.5 - ribbon.start;
    return vec2(offset.x * line.normal.y - offset.y * line.normal.x, dot(offset, line.normal));
}

// Where along the ribbon a pixel is, 0 to less than 1 between its ends, or -1 where the pixel belongs to another segment of the
// strand. They are divided at the bisectors of joints, half-open, so that segments share no pixel and leave none out.
fn place_of(ribbon: Ribbon, line: Line, pixel: vec2<u32>) -> f32 {
    let at = beside(ribbon, line, pixel);
    let is_behind = vec2(at.x, at.x - line.length) + vec2(-1.0, 1.0) * ribbon.tilt * at.y >= vec2(0.0);
    let is_end = ribbon.tilt == vec2(ROUND);
    let is_own = (is_behind.x || is_end.x) && (!is_behind.y || is_end.y);
    return select(-1.0, clamp(at.x * line.per_length, 0.0, LAST_PLACE), is_own);
}

fn is_sharp(ribbon: Ribbon) -> vec2<bool> {
    return abs(ribbon.tilt) > vec2(SHARP);
}

// Whether the ribbon has an end of its own in the pixels: most segments go straight on at both ends.
fn has_ends_of(ribbon: Ribbon) -> bool {
    return any(is_sharp(ribbon));
}

// Pixels by which the ends go on behind their round ends.
fn slack_of(ribbon: Ribbon) -> vec2<f32> {
    return select(vec2(ENDLESS), select(vec2(ELBOW), vec2(0.0), ribbon.tilt == vec2(ROUND)), is_sharp(ribbon));
}

// The least length that a pixel is taken with: below that, thin fibres that are seen end-on would come and go.
const SHORTEST_PIXEL: f32 = 0.5;

// How long a pixel is taken along the line, where so much of the line belongs to the segment. The pixels before a joint know nothing of
// the round end behind it: what those behind the end get more, the segment's own pixels before the end must lose.
fn pixel_length(ribbon: Ribbon, line: Line, owned: f32) -> f32 {
    let whole = line.reach.x + line.reach.y;
    let has_joint = any(ribbon.tilt != vec2(ROUND));
    return select(whole, clamp(2.0 * owned, SHORTEST_PIXEL, whole), has_joint);
}

// How far the surface that a pixel sees is from the axis, towards the eye.
fn rise_at(ribbon: Ribbon, line: Line, pixel: vec2<u32>, place: f32) -> f32 {
    let half_width = mix(ribbon.half_width.x, ribbon.half_width.y, place);
    // Of a thin fibre a pixel sees all of its width.
    var rise = MEAN_RISE * half_width;
    if half_width > THIN {
        rise = rise_of(beside(ribbon, line, pixel).y, half_width);
    }
    return rise;
}

// Where along the segment the surface is that rises so far above `place`, see `slant_of`.
fn surface_at(ribbon: Ribbon, place: f32, rise: f32, slant: f32) -> f32 {
    return clamp(along(ribbon, place) + rise * slant, -SURPLUS, 1.0 + SURPLUS);
}

// What the ribbon leaves in a pixel at `place` along it, wherever the scene is. Its colour is that of the surface that the pixel sees.
fn fragment_on(ribbon: Ribbon, line: Line, slant: f32, paint: Paint, pixel: vec2<u32>, place: f32, has_ends: bool) -> Fragment {
    let shown = surface_at(ribbon, place, rise_at(ribbon, line, pixel, place), slant);
    return fragment_showing(ribbon, line, paint, pixel, place, shown, has_ends);
}

// The same where a segment is looked at in this pixel alone. The slant is found when it is needed: kept from before, it takes registers.
fn fragment_alone(ribbon: Ribbon, line: Line, paint: Paint, pixel: vec2<u32>, place: f32) -> Fragment {
    let rise = rise_at(ribbon, line, pixel, place);
    let shown = surface_at(ribbon, place, rise, slant_of(view.lens, ribbon));
    return fragment_showing(ribbon, line, paint, pixel, place, shown, has_ends_of(ribbon));
}

// The same with the colour of the axis.
fn fragment_of_axis(ribbon: Ribbon, line: Line, paint: Paint, pixel: vec2<u32>, place: f32) -> Fragment {
    return fragment_showing(ribbon, line, paint, pixel, place, along(ribbon, place), has_ends_of(ribbon));
}

// What the ribbon leaves in a pixel at `place` along it, with the colour that the segment has at `shown`.
fn fragment_showing(ribbon: Ribbon, line: Line, paint: Paint, pixel: vec2<u32>, place: f32, shown: f32, has_ends: bool) -> Fragment {
    let half_width = mix(ribbon.half_width.x, ribbon.half_width.y, place);
    let at = beside(ribbon, line, pixel);
    var covered = coverage(at.y, half_width, line.reach);
    if has_ends {
        let rise = rise_of(at.y, half_width);
        let ends = rise + slack_of(ribbon);
        covered *= between(at.x + ends.x, line.length - at.x + ends.y, pixel_length(ribbon, line, line.length + rise));
    }
    let color = max(mix(paint.start.rgb, paint.end.rgb, shown), vec3(0.0));
    let opacity = mix(paint.start.a, paint.end.a, along(ribbon, place));
    let nearness = mix(ribbon.nearness.x, ribbon.nearness.y, place);
    let alpha = u32(round(saturate(covered * opacity) * OPAQUE));
    @if(!places) { return Fragment(color, nearness, alpha); }
    @if(places) { return Fragment(color, nearness, alpha, stripe_of(at.y, half_width, line.normal)); }
}

// What the ribbon leaves in a pixel: nothing in one of another segment, and nothing behind the scene.
fn fragment_at(ribbon: Ribbon, line: Line, slant: f32, paint: Paint, pixel: vec2<u32>, has_ends: bool) -> Fragment {
    let place = place_of(ribbon, line, pixel);
    if place < 0.0 {
        return Fragment();
    }
    let scene = scene_nearness(pixel);
    var fragment = fragment_on(ribbon, line, slant, paint, pixel, place, has_ends);
    fragment.alpha = select(fragment.alpha, 0u, fragment.nearness < scene);
    return fragment;
}

// The pixels that a ribbon may touch: columns along the axis that it follows most, and in each the rows around its middle.
struct Span {
    // Whether columns run down the screen instead of across.
    steep: bool,
    first_column: i32,
    last_column: i32,
    // Pixels along a row and along a column.
    size: vec2<i32>,
    start: vec2<f32>,
    slope: f32,
    half_height: f32,
}

// Pixels by which a ribbon of half the width `extent` reaches beyond its start and its end.
fn overshoot(ribbon: Ribbon, extent: f32) -> vec2<f32> {
    return select(extent * abs(ribbon.tilt), extent + slack_of(ribbon), is_sharp(ribbon));
}

fn span_of(ribbon: Ribbon, line: Line) -> Span {
    let steep = abs(line.delta.y) > abs(line.delta.x);
    let start = select(ribbon.start, ribbon.start.yx, steep);
    let end = select(ribbon.end, ribbon.end.yx, steep);
    let delta = select(line.delta, line.delta.yx, steep);
    let size = select(vec2<i32>(view.size), vec2<i32>(view.size.yx), steep);
    let extent = max(ribbon.half_width.x, ribbon.half_width.y) + line.reach.x;
    let across = select(abs(line.normal), abs(line.normal.yx), steep);
    // Along a row: beside the ribbon, and beyond its ends.
    let overhang = extent * across.x + overshoot(ribbon, extent) * across.y;
    let low = min(start.x - overhang.x, end.x - overhang.y);
    let high = max(start.x + overhang.x, end.x + overhang.y);
    let first = max(i32(ceil(low - 0.5)), 0);
    let last = min(i32(floor(high - 0.5)), size.x - 1);
    return Span(steep, first, last, size, start, delta.y / delta.x, extent / across.y);
}

// The row, not rounded, that the middle of the ribbon is at in a column.
fn middle_of(span: Span, column: i32) -> f32 {
    return span.start.y + span.slope * (f32(column) + 0.5 - span.start.x) - 0.5;
}

// A segment without a length is seen where its strand begins or ends, as a disc.
fn is_drawn(ribbon: Ribbon, line: Line) -> bool {
    let delta = ribbon.end - ribbon.start;
    return ribbon.visible && (dot(delta, delta) >= SHORTEST || any(ribbon.tilt == vec2(ROUND)));
}
