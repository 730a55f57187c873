// Tapered capsules.

import package::vector::{across, direction_or};

struct GpuCapsule { a: vec3<f32>, radius_a: f32, b: vec3<f32>, radius_b: f32 }

/// The point of the axis that is nearest to `point`, and the radius there.
fn nearest(capsule: GpuCapsule, point: vec3<f32>) -> vec4<f32> {
    let axis = capsule.b - capsule.a;
    let squared = dot(axis, axis);
    let t = select(0.0, clamp(dot(point - capsule.a, axis) / squared, 0.0, 1.0), squared > 0.0);
    return vec4(capsule.a + t * axis, capsule.radius_a + t * (capsule.radius_b - capsule.radius_a));
}

/// How far `point` can go before it may be inside. The radius changes along the axis too, so that is less than the distance
/// from the surface where a capsule is tapered.
fn clearance(capsule: GpuCapsule, point: vec3<f32>, sphere: vec4<f32>) -> f32 {
    let axis = distance(capsule.a, capsule.b);
    let taper = select(0.0, abs(capsule.radius_b - capsule.radius_a) / axis, axis > 0.0);
    return (distance(point, sphere.xyz) - sphere.w) / (1.0 + taper);
}

/// Turns a vertex that is inside of a sphere about its parent until it is on it: the distance from the parent stays. In the
/// plane of parent, centre and `heading` that is a triangle of three known sides. Where the parent is so deep inside that no
/// turn is enough, the vertex ends straight outwards.
///
/// `heading` is the way of the edge before anything moved. The way to where the vertex was would not do: in a strand that
/// crosses the sphere nearly at right angles each vertex would multiply the errors of its parent.
fn turned_out(parent: vec3<f32>, heading: vec3<f32>, length: f32, sphere: vec4<f32>) -> vec3<f32> {
    let from_center = parent - sphere.xyz;
    let distance = sqrt(dot(from_center, from_center));
    let outwards = direction_or(from_center, vec3(0.0, 1.0, 0.0));
    let sideways = direction_or(heading - dot(heading, outwards) * outwards, across(outwards));
    // Cosine and sine of the angle between `outwards` and the new edge, from the sides; the sine as Heron has it, since a
    // square root of 1 minus the squared cosine would lose half of the digits where the angle is small.
    let gap = distance + length - sphere.w;
    let product = gap * (distance + length + sphere.w) * (sphere.w - distance + length) * (sphere.w + distance - length);
    let twice = max(2.0 * distance * length, 1e-24);
    let c = ((sphere.w - distance) * (sphere.w + distance) - length * length) / twice;
    if (product <= 0.0) { return parent + length * sign(c) * outwards; }
    return parent + length * (clamp(c, -1.0, 1.0) * outwards + min(sqrt(product) / twice, 1.0) * sideways);
}

/// What is left of a displacement along a surface after Coulomb friction against a push of `depth` along `normal` (Macklin
/// et al. 2014). The push itself is no motion and is taken out as well. A touch of no depth changes nothing; nothing sticks.
fn slid(displacement: vec3<f32>, normal: vec3<f32>, depth: f32, friction: f32) -> vec3<f32> {
    let along_normal = dot(displacement, normal);
    let slide = displacement - along_normal * normal;
    let lost = min(friction * depth, sqrt(dot(slide, slide)));
    let pushed = min(depth, max(along_normal, 0.0));
    return displacement - lost * direction_or(slide, vec3(0.0)) - pushed * normal;
}
