// Tapered capsules.

import package::vector::{direction_or, rotate_back};

struct GpuCapsule { a: vec3<f32>, radius_a: f32, b: vec3<f32>, radius_b: f32 }

/// The motion of a capsule during the sub-step, in the space of the head, relative to the centre of the groom: its points
/// are rotated, then moved by `translation`. And of the capsule, where there is room for it: the share of the distance from its surface that
/// a point can move in any direction and not come inside. The radius of a tapered one changes along its axis.
struct GpuCapsuleMotion { rotation: vec4<f32>, translation: vec3<f32>, clear_share: f32 }

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

/// A distance that a point can move in any direction and not come inside.
fn clearance(collider: Collider, point: vec3<f32>) -> f32 {
    let sphere = nearest(collider.capsule, point);
    return (distance(point, sphere.xyz) - sphere.w) * collider.motion.clear_share;
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
