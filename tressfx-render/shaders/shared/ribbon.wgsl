// A segment of a strand on the screen: a strip between two points with a width, a distance and a colour at either end.

// In view space: position, x right, y up, -z ahead.
struct End {
    point: vec3<f32>,
    radius: f32,
}

struct Ribbon {
    // Pixels, y down.
    start: vec2<f32>,
    end: vec2<f32>,
    half_width: vec2<f32>,
    // 1 / distance from the plane of the eye. It is linear on the screen, as half_width is.
    nearness: vec2<f32>,
    // Where the ends are on the segment that it was cut from, 0 to 1.
    part: vec2<f32>,
    visible: bool,
}

// Coordinates this large are no hair: NaN and infinity have larger bits too.
const LARGEST_BITS: u32 = 0x5368d4a5u; // 1e12

fn is_sound(point: vec3<f32>) -> bool {
    return all((bitcast<vec3<u32>>(point) & vec3(0x7fffffffu)) < vec3(LARGEST_BITS));
}

// Cuts off what is nearer than the near plane, and projects: `focal` is in pixels, `center` is where the eye looks.
fn project(a: End, b: End, near: f32, focal: f32, center: vec2<f32>) -> Ribbon {
    var ribbon: Ribbon;
    let distances = vec2(-a.point.z, -b.point.z);
    if max(distances.x, distances.y) <= near {
        return ribbon;
    }
    let crossing = saturate((near - distances.x) / (distances.y - distances.x));
    let part = vec2(select(0.0, crossing, distances.x < near), select(1.0, crossing, distances.y < near));
    let nearness = 1.0 / max(mix(distances.xx, distances.yy, part), vec2(near));
    let scale = focal * nearness;
    ribbon.start = center + mix(a.point.xy, b.point.xy, part.x) * vec2(scale.x, -scale.x);
    ribbon.end = center + mix(a.point.xy, b.point.xy, part.y) * vec2(scale.y, -scale.y);
    ribbon.half_width = mix(vec2(a.radius), vec2(b.radius), part) * scale;
    ribbon.nearness = nearness;
    ribbon.part = part;
    ribbon.visible = true;
    return ribbon;
}

// Where on a segment, 0 to 1, its screen parameter `t` is, that is 0 and 1 at the ribbon's ends.
fn along(ribbon: Ribbon, t: f32) -> f32 {
    let true_part = t * ribbon.nearness.y / mix(ribbon.nearness.x, ribbon.nearness.y, t);
    return mix(ribbon.part.x, ribbon.part.y, true_part);
}

// Cuts off what is further than `margin` outside the image, so that coordinates stay small.
fn clip(ribbon: Ribbon, size: vec2<f32>, margin: f32) -> Ribbon {
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
    cut.part = vec2(along(ribbon, t.x), along(ribbon, t.y));
    return cut;
}
