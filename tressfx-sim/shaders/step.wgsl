// What changes from sub-step to sub-step. Lengths in the unit of the file; shares and displacements are those of one sub-step.

struct Step {
    /// From the axes of the rest pose to those of the world: the rotation of the head at the end of the sub-step.
    head_rotation: vec4<f32>,
    /// The rotation that the head made during the sub-step.
    turn: vec4<f32>,
    /// The way that the centre of the groom made with the head during the sub-step. All positions are about that centre.
    shift: vec3<f32>,
    /// Share of the velocity that is kept.
    keep: f32,
    /// Displacement by gravity.
    gravity: vec3<f32>,
    /// The longest displacement relative to the head.
    max_displacement: f32,
    /// Displacement by the wind from the four corners of its cone, across an edge.
    wind: array<vec4<f32>, 4>,
    global_stiffness: f32,
    /// Share of the strand, from the root, that the global shape reaches.
    global_range: f32,
    /// Share of the way in one iteration, by both vertices of an edge together.
    local_stiffness: f32,
    /// Coefficient of sliding friction.
    friction: f32,
    tip_separation: f32,
    /// Share of the head's motion that the strands make at once.
    shock: f32,
    /// Not 0: the strands go to their rest pose, at rest.
    reset: u32,
    padding: u32,
}
