// Contact with capsules: a vertex that is inside of one is pushed straight out of it, and slides on it with friction. With the feature `fields` some of them
// are signed distance fields.

import package::capsule::{Collider, clearance, nearest, origin_of, slid};
import package::integrate::Free;
import package::root::{Root, carried_from};
import package::step::step;
import package::vector::{direction_or, rotate, rotate_back};
@if(fields)
import package::field_contact::{SLOPE, beside, is_field, sample_of};

@group(0) @binding(5) var<storage, read> colliders: array<Collider>;

/// Larger than any groom.
const FAR: f32 = 1e30;
/// A computed clearance is multiplied by this, so that rounding cannot make it too large.
const CERTAIN: f32 = 0.999;

/// How far a point may go and touch no capsule; 0 or less if it is inside of one.
fn clear_distance(point: vec3<f32>) -> f32 {
    let in_head = rotate_back(step.head_rotation, point);
    var clear = FAR;
    for (var i = step.first_capsule; i < step.end_capsule; i++) {
        @if(fields) {
            if (is_field(colliders[i].capsule)) {
                clear = min(clear, SLOPE * sample_of(colliders[i].capsule, in_head).distance);
                continue;
            }
        }
        clear = min(clear, clearance(colliders[i], in_head));
    }
    return CERTAIN * clear;
}

/// A point after the capsules, one after the other, and the past that gives it the displacement that they leave.
fn pushed_out(root: Root, position: vec3<f32>, past: vec3<f32>) -> Free {
    let before = rotate_back(step.head_rotation, position);
    var point = before;
    var displacement = rotate_back(step.head_rotation, position - past);
    for (var i = step.first_capsule; i < step.end_capsule; i++) {
        @if(fields) {
            if (is_field(colliders[i].capsule)) {
                let surface = surface_displacement(root, point, i);
                let push = beside(colliders[i].capsule, point, displacement - surface);
                let size = sqrt(dot(push, push));
                if (size > 0.0) {
                    displacement = surface + slid(displacement + push - surface, push / size, size, step.friction);
                    point += push;
                }
                continue;
            }
        }
        let sphere = nearest(colliders[i].capsule, point);
        let from_center = point - sphere.xyz;
        if (dot(from_center, from_center) < sphere.w * sphere.w) {
            let normal = direction_or(from_center, vec3(0.0, 1.0, 0.0));
            let push = sphere.w * normal - from_center;
            let surface = surface_displacement(root, point, i);
            let depth = max(dot(push, normal), 0.0);
            displacement = surface + slid(displacement + push - surface, normal, depth, step.friction);
            point += push;
        }
    }
    let after = position + rotate(step.head_rotation, point - before);
    return Free(after, after - rotate(step.head_rotation, displacement));
}

/// How far a point has gone at most as a field sees it.
@if(fields)
fn longest_way(root: Root, position: vec3<f32>, past: vec3<f32>) -> f32 {
    let point = rotate_back(step.head_rotation, position);
    let displacement = rotate_back(step.head_rotation, position - past);
    var longest = 0.0;
    for (var i = step.first_capsule; i < step.end_capsule; i++) {
        if (is_field(colliders[i].capsule)) { longest = max(longest, length(displacement - surface_displacement(root, point, i))); }
    }
    return longest;
}

/// The displacement of a capsule's surface at a point, on the axes of the head. Like that of a vertex it leaves out the share of the
/// root's motion that the velocity shock has added to the vertex's past.
fn surface_displacement(root: Root, point: vec3<f32>, capsule: u32) -> vec3<f32> {
    let here = rotate(step.head_rotation, point);
    let own = point - origin_of(colliders[capsule].motion, point);
    let with_head = here - rotate_back(step.head_turn, here) + step.center_displacement;
    let with_root = here - carried_from(root, here) + step.center_displacement;
    return own + rotate_back(step.head_rotation, with_head - step.shock * with_root);
}
