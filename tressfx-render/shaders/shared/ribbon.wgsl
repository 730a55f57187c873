// A segment of a strand on the screen: a strip between two points with a width and a nearness at either end.

import package::view::LensUniform;

// In the space of the eye: x right, y up, -z ahead.
struct End {
    point: vec3<f32>,
    radius: f32,
}

struct Ribbon {
    // Pixels, y down.
    start: vec2<f32>,
    end: vec2<f32>,
    half_width: vec2<f32>,
    // See the lens. It is linear on the screen, as half_width is.
    nearness: vec2<f32>,
    // Where the ends are on the segment that it was cut from, 0 to 1.
    part: vec2<f32>,
    // 1 / w at the ends: what is linear along the segment is not linear on the screen.
    scale: vec2<f32>,
    // How the strand goes on at the ends, see `joint`.
    tilt: vec2<f32>,
    visible: bool,
}

// Coordinates this large are no hair: NaN and infinity have larger bits too.
const LARGEST_BITS: u32 = 0x5368d4a5u; // 1e12

fn is_sound(point: vec3<f32>) -> bool {
    return all((bitcast<vec3<u32>>(point) & vec3(0x7fffffffu)) < vec3(LARGEST_BITS));
}

// The pixel of a point whose 1 / w is `scale`.
fn on_screen(lens: LensUniform, point: vec2<f32>, scale: f32) -> vec2<f32> {
    let focal = lens.focal * scale;
    return lens.center + vec2(focal.x * point.x, -(lens.skew * scale * point.x + focal.y * point.y));
}

// What `on_screen` makes so many pixels of, from the centre and at w 1.
fn off_screen(lens: LensUniform, pixels: vec2<f32>) -> vec2<f32> {
    let right = pixels.x / lens.focal.x;
    return vec2(right, -(pixels.y + lens.skew * right) / lens.focal.y);
}

// Pixels of half a unit of width at w 1, across a line on the screen through a point. What is seen of a fibre are the lines in which planes
// through the eye touch it: away from the centre they are farther apart than the fibre is wide.
fn width_scale(lens: LensUniform, at: vec2<f32>, delta: vec2<f32>) -> f32 {
    let from_center = at - lens.center;
    let square = max(dot(delta, delta), 1e-20);
    let moment = f32(lens.is_perspective) * (delta.x * from_center.y - delta.y * from_center.x);
    if lens.even_focal > 0.0 {
        return sqrt(lens.even_focal * lens.even_focal + moment * moment / square);
    }
    let across = vec2(lens.focal.x * delta.y + lens.skew * delta.x, lens.focal.y * delta.x);
    return sqrt((dot(across, across) + moment * moment) / square);
}

// Cuts off what is nearer than the near plane, and projects.
fn project(a: End, b: End, lens: LensUniform) -> Ribbon {
    var ribbon: Ribbon;
    let distances = vec2(-a.point.z, -b.point.z);
    if max(distances.x, distances.y) <= lens.near {
        return ribbon;
    }
    let crossing = saturate((lens.near - distances.x) / (distances.y - distances.x));
    let part = vec2(select(0.0, crossing, distances.x < lens.near), select(1.0, crossing, distances.y < lens.near));
    let distance = max(mix(distances.xx, distances.yy, part), vec2(lens.near));
    var scale = vec2(1.0);
    if lens.is_perspective == 1u {
        scale = 1.0 / distance;
        ribbon.nearness = scale;
    } else {
        ribbon.nearness = 1.0 - lens.nearness_slope * distance;
    }
    ribbon.start = on_screen(lens, mix(a.point.xy, b.point.xy, part.x), scale.x);
    ribbon.end = on_screen(lens, mix(a.point.xy, b.point.xy, part.y), scale.y);
    let width = width_scale(lens, ribbon.start, ribbon.end - ribbon.start);
    ribbon.half_width = mix(vec2(a.radius), vec2(b.radius), part) * (width * scale);
    ribbon.part = part;
    ribbon.scale = scale;
    ribbon.visible = true;
    return ribbon;
}

// 1 / w of points by their nearness.
fn scale_of(lens: LensUniform, nearness: vec2<f32>) -> vec2<f32> {
    return select(vec2(1.0), nearness, lens.is_perspective == 1u);
}

// 1 / w of a point by its distance from the plane of the eye.
fn scale_at(lens: LensUniform, distance: f32) -> f32 {
    return select(1.0, 1.0 / distance, lens.is_perspective == 1u);
}

// Pixels around the image within which all is kept that a ribbon of this half width may cover.
fn margin_of(half_width: vec2<f32>) -> f32 {
    return 1.25 * max(half_width.x, half_width.y) + 2.0;
}

// Where on a segment, 0 to 1, its screen parameter `t` is, that is 0 and 1 at the ribbon's ends.
fn along(ribbon: Ribbon, t: f32) -> f32 {
    return mix(ribbon.part.x, ribbon.part.y, t * ribbon.scale.y / mix(ribbon.scale.x, ribbon.scale.y, t));
}

// The eye meets the surface of a fibre before its axis. Where the fibre leads towards the eye, a pixel shows a part that is farther along it
// than the axis there: by so much of the segment for each pixel by which the surface rises. It is the cotangent of the angle between the
// segment and the ray through its middle, over the length of the segment.
fn slant_of(lens: LensUniform, ribbon: Ribbon) -> f32 {
    var across = ribbon.end - ribbon.start;
    let focal = abs(lens.focal.x);
    var ray = (lens.center - 0.5 * (ribbon.start + ribbon.end)) / focal;
    if lens.even_focal == 0.0 {
        across = focal * off_screen(lens, across);
        ray = off_screen(lens, focal * ray);
    }
    // By how much the segment leads towards the eye. All lengths are in pixels of the mean distance of its ends, which in a perspective are
    // larger than those of its middle on the screen.
    var nearer = ribbon.nearness.y - ribbon.nearness.x;
    var larger = 1.0;
    if lens.is_perspective == 1u {
        nearer *= 2.0 / max(ribbon.nearness.x + ribbon.nearness.y, 1e-30);
        larger = 1.0 - 0.25 * nearer * nearer;
    } else {
        nearer /= lens.nearness_slope;
        ray = vec2(0.0);
    }
    let towards = focal * nearer;
    // The segment is `vec3(across, 0) + towards * vec3(ray, 1)`.
    let square = dot(across, across);
    let beside = across.x * ray.y - across.y * ray.x;
    let along = dot(across, ray);
    let ahead = towards * (1.0 + dot(ray, ray));
    let lengths = (square + beside * beside) * (square + towards * (2.0 * along + ahead));
    let share = larger * focal * (ribbon.part.y - ribbon.part.x) / width_scale(lens, ribbon.start, ribbon.end - ribbon.start);
    return (along + ahead) * share * inverseSqrt(max(lengths, 1e-30));
}

// Cuts off what is further than `margin` outside the image, so that coordinates stay small.
fn clip(ribbon: Ribbon, lens: LensUniform, size: vec2<f32>, margin: f32) -> Ribbon {
    let delta = ribbon.end - ribbon.start;
    let parallel = abs(delta) < vec2(1e-6);
    let step = select(delta, vec2(1.0), parallel);
    let one = (vec2(-margin) - ribbon.start) / step;
    let other = (size + margin - ribbon.start) / step;
    let inside = (ribbon.start > vec2(-margin)) & (ribbon.start < size + margin);
    let enter = select(min(one, other), select(vec2(2.0), vec2(0.0), inside), parallel);
    let leave = select(max(one, other), vec2(1.0), parallel);
    let t = vec2(max(0.0, max(enter.x, enter.y)), min(1.0, min(leave.x, leave.y)));
    var cut = ribbon;
    cut.visible = ribbon.visible && t.x < t.y;
    cut.start = mix(ribbon.start, ribbon.end, t.x);
    cut.end = mix(ribbon.start, ribbon.end, t.y);
    cut.half_width = mix(ribbon.half_width.xx, ribbon.half_width.yy, t);
    cut.nearness = mix(ribbon.nearness.xx, ribbon.nearness.yy, t);
    cut.scale = scale_of(lens, cut.nearness);
    cut.part = vec2(along(ribbon, t.x), along(ribbon, t.y));
    cut.tilt = select(ribbon.tilt, vec2(0.0), vec2(t.x > 0.0, t.y < 1.0));
    return cut;
}
