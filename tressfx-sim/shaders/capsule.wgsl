// Tapered capsules.

import package::vector::{across, direction_or, rotate_back};

struct GpuCapsule { a: vec3<f32>, radius_a: f32, b: vec3<f32>, radius_b: f32 }

/// The motion of a capsule during the sub-step, in the space of the head, relative to the centre of the groom: its points
/// are rotated, then moved by `translation`.
struct GpuCapsuleMotion { rotation: vec4<f32>, translation: vec3<f32>, padding: f32 }

/// Where a point of a capsule was at the beginning of the sub-step.
fn origin_of(motion: GpuCapsuleMotion, point: vec3<f32>) -> vec3<f32> {
    return rotate_back(motion.rotation, point - motion.translation);
}

/// A capsule relative to an origin.
fn relative_to(origin: vec3<f32>, capsule: GpuCapsule) -> GpuCapsule {
    return GpuCapsule(capsule.a - origin, capsule.radius_a, capsule.b - origin, capsule.radius_b);
}

/// The point of the axis that is nearest to `point`, and the radius there.
fn nearest(capsule: GpuCapsule, point: vec3<f32>) -> vec4<f32> {
    let axis = capsule.b - capsule.a;
    let squared = dot(axis, axis);
    let t = select(0.0, clamp(dot(point - capsule.a, axis) / squared, 0.0, 1.0), squared > 0.0);
    return vec4(capsule.a + t * axis, capsule.radius_a + t * (capsule.radius_b - capsule.radius_a));
}

/// A distance that `point` can move in any direction and not come inside. For a tapered capsule it is less than the distance
/// from `sphere`, since the radius changes along the axis.
fn clearance(capsule: GpuCapsule, point: vec3<f32>, sphere: vec4<f32>) -> f32 {
    let axis = distance(capsule.a, capsule.b);
    let taper = select(0.0, abs(capsule.radius_b - capsule.radius_a) / axis, axis > 0.0);
    return (distance(point, sphere.xyz) - sphere.w) / (1.0 + taper);
}

/// The limit of a turn: a vertex moves by no more than this times its depth, or this times its distance from the line through
/// parent and centre if that is less. It is also the factor by which a contact can enlarge a rounding error.
const TURN_LIMIT: f32 = 4.0;
/// A turn does not end at a smaller angle between the edge and the direction straight outwards than that with this sine. At
/// smaller angles the turn goes with the square root of the depth.
const MIN_SINE_AFTER_TURN: f32 = 1.0 / TURN_LIMIT;
/// A vertex whose edge points straight at a centre is treated as if it were beside the line through parent and centre, by this
/// share of the parent's distance from the centre: with a distance of 0 the limit would be 0, and it would never get out. It is
/// roughly the precision of a position in f32.
const MIN_DISTANCE_FROM_LINE: f32 = 1e-7;

/// The new place of a vertex, and the share of the limit on turns that was used.
struct Turn { point: vec3<f32>, used_share: f32 }

/// Turns a vertex that is inside of a sphere about its parent until it is on the surface; its distance from the parent stays. The
/// turn is in the plane of parent, centre and `aim`, the direction that it starts from. Parent, centre and vertex are then a
/// triangle whose three sides are known.
///
/// The turn is limited, and goes on in the next sub-step: where the edge points nearly at the centre, rounding decides on
/// the plane, and the turn goes with the square root of the depth. `unused_share` is the share of the limit that earlier
/// turns of this sub-step have not used: between two capsules a vertex is turned back and forth, and each turn enlarges the
/// errors of the one before. Where the parent is so deep inside that the edge just reaches the surface, or does not reach
/// it, the vertex ends as straight outwards as `MIN_SINE_AFTER_TURN` allows, or keeps its angle if that is smaller. Where
/// the parent is at the centre, no direction is outwards.
///
/// The result is a continuous function of the arguments: a vertex that is only just inside is rotated only a little.
fn turned_out(parent: vec3<f32>, aim: vec3<f32>, length: f32, sphere: vec4<f32>, unused_share: f32) -> Turn {
    let from_center = parent - sphere.xyz;
    let distance = sqrt(dot(from_center, from_center));
    let outwards = direction_or(from_center, vec3(0.0, 1.0, 0.0));
    let before = direction_or(aim, outwards);
    // Cosines and sines are those of the angle between `outwards` and the edge.
    let old_cosine = dot(before, outwards);
    // Done twice. If the two directions are nearly equal, what rounding leaves of their difference may lie along them
    // instead of across, and a rotation to that side would not move the vertex.
    var across_outwards = before - old_cosine * outwards;
    across_outwards -= dot(across_outwards, outwards) * outwards;
    let old_sine = sqrt(dot(across_outwards, across_outwards));
    // On the sphere, from the sides; the sine as Heron has it, since a square root of 1 minus the squared cosine would lose
    // half of the digits where the angle is small.
    let gap = distance + length - sphere.w;
    let product = gap * (distance + length + sphere.w) * (sphere.w - distance + length) * (sphere.w + distance - length);
    let twice = max(2.0 * distance * length, 1e-24);
    var cosine = ((sphere.w - distance) * (sphere.w + distance) - length * length) / twice;
    var sine = sqrt(max(product, 0.0)) / twice;
    let straightest = sqrt(1.0 - MIN_SINE_AFTER_TURN * MIN_SINE_AFTER_TURN);
    if (cosine > max(old_cosine, straightest)) {
        let straighter = old_cosine > straightest;
        cosine = select(straightest, old_cosine, straighter);
        sine = select(MIN_SINE_AFTER_TURN, old_sine, straighter);
    }
    // Tangents of half of the turn, and of half of its bound.
    let turn = (old_sine * cosine - old_cosine * sine) / max(1.0 + old_cosine * cosine + old_sine * sine, 1e-12);
    let share_of_length = distance / max(length, 1e-12);
    let from_line = select(sine * sine, max(old_sine, MIN_DISTANCE_FROM_LINE * share_of_length), turn > 0.0);
    let limit = 0.5 * TURN_LIMIT * max(from_line, 1e-12);
    let bound = unused_share * min(limit, 0.5 * TURN_LIMIT * min(abs(cosine - old_cosine), share_of_length));
    if (abs(turn) > bound) {
        let half = sign(turn) * bound;
        let part = vec2(2.0 * half, 1.0 - half * half) / (1.0 + half * half);
        cosine = old_cosine * part.y + old_sine * part.x;
        sine = old_sine * part.y - old_cosine * part.x;
    }
    let sideways = direction_or(across_outwards, across(outwards));
    return Turn(parent + length * (cosine * outwards + sine * sideways), min(min(abs(turn), bound) / limit, 1.0));
}

/// What is left of a displacement along a surface after Coulomb friction against a push of `depth` along `normal` (Macklin
/// et al. 2014). The push itself is no motion and is taken out as well. At depth 0 nothing changes. There is no static
/// friction.
fn slid(displacement: vec3<f32>, normal: vec3<f32>, depth: f32, friction: f32) -> vec3<f32> {
    let along_normal = dot(displacement, normal);
    let slide = displacement - along_normal * normal;
    let lost = min(friction * depth, sqrt(dot(slide, slide)));
    let pushed = min(depth, max(along_normal, 0.0));
    return displacement - lost * direction_or(slide, vec3(0.0)) - pushed * normal;
}
