// Tapered capsules.

import package::vector::{direction_or, rotate_back};

struct GpuCapsule { a: vec3<f32>, radius_a: f32, b: vec3<f32>, radius_b: f32 }

/// The motion of a capsule during the sub-step, in the space of the head, relative to the centre of the groom: its points
/// are rotated, then moved by `translation`.
struct GpuCapsuleMotion { rotation: vec4<f32>, translation: vec3<f32>, padding: f32 }

/// Something to collide with: at the end of the sub-step, in the space of the rest pose, relative to the centre of the groom, and how it has moved.
struct Collider { capsule: GpuCapsule, motion: GpuCapsuleMotion }

/// Where a point of a capsule was at the beginning of the sub-step.
fn origin_of(motion: GpuCapsuleMotion, point: vec3<f32>) -> vec3<f32> {
    return rotate_back(motion.rotation, point - motion.translation);
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
    return (distance(point, sphere.xyz) - sphere.w) / (1.0 + taper_of(capsule));
}

/// By how much the radius of a capsule changes along its axis.
fn taper_of(capsule: GpuCapsule) -> f32 {
    let axis = distance(capsule.a, capsule.b);
    return select(0.0, abs(capsule.radius_b - capsule.radius_a) / axis, axis > 0.0);
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
