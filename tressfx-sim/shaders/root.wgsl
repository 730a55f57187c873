// How the root of a guide moves: with the head, or, with the feature `roots`, by a transform of its own.

import package::step::step;
import package::vector::{after, rotate, rotate_back};

/// Where a guide's root takes its rest pose: a point of the rest pose, relative to the centre of the groom, is turned and
/// then moved to a place relative to the centre on the axes of the world. At the end of the sub-step, and one sub-step ago
/// relative to the centre of then.
@if(roots)
struct GuideRoot { rotation: vec4<f32>, place: vec4<f32>, last_rotation: vec4<f32>, last_place: vec4<f32> }

/// One a guide.
@if(roots)
@group(0) @binding(9) var<storage, read> roots: array<GuideRoot>;

/// The motion of a root during the sub-step.
struct Root {
    /// From the axes of the rest pose to those of the world, at the end of the sub-step.
    rotation: vec4<f32>,
    /// The rotation during the sub-step.
    turn: vec4<f32>,
    /// Where the centre of the rest pose is taken, at the end of the sub-step.
    @if(roots) place: vec3<f32>,
    /// The same one sub-step ago, relative to the centre of then.
    @if(roots) last_place: vec3<f32>,
}

@if(!roots)
fn root_of(guide: u32) -> Root {
    return Root(step.head_rotation, step.head_turn);
}

@if(roots)
fn root_of(guide: u32) -> Root {
    let root = roots[guide];
    let last = root.last_rotation;
    return Root(root.rotation, after(root.rotation, vec4(-last.xyz, last.w)), root.place.xyz, root.last_place.xyz);
}

/// Where the root takes a point of the rest pose.
fn shape_of(root: Root, rest: vec3<f32>) -> vec3<f32> {
    @if(!roots) { return rotate(root.rotation, rest); }
    @if(roots) { return rotate(root.rotation, rest) + root.place; }
}

/// Where the root's motion takes a point; `last` is its place one sub-step ago, relative to the centre of then.
fn carried(root: Root, last: vec3<f32>) -> vec3<f32> {
    @if(!roots) { return rotate(root.turn, last); }
    @if(roots) { return rotate(root.turn, last - root.last_place) + root.place; }
}

/// The root's motion moves no point by more than the first of these times its distance from the centre, and the second.
fn most_carried(root: Root) -> vec2<f32> {
    let turn = 2.0 * length(root.turn.xyz);
    @if(!roots) { return vec2(turn, (1.0 + turn) * length(step.center_displacement)); }
    @if(roots) {
        let way = length(root.place - root.last_place + step.center_displacement);
        return vec2(turn, turn * (length(root.last_place) + length(step.center_displacement)) + way);
    }
}

/// Where a point was one sub-step ago that the root's motion has taken here; relative to the centre of then.
fn carried_from(root: Root, here: vec3<f32>) -> vec3<f32> {
    @if(!roots) { return rotate_back(root.turn, here); }
    @if(roots) { return rotate_back(root.turn, here - root.place) + root.last_place; }
}
