// What a kernel is told about a sub-step of a section. Lengths are in the unit of the file; shares and displacements are those
// of one sub-step.

struct Step {
    /// From the axes of the rest pose to those of the world: the rotation of the head at the end of the sub-step.
    head_rotation: vec4<f32>,
    /// The rotation that the head made during the sub-step.
    head_turn: vec4<f32>,
    /// The displacement of the centre of the groom, which moves with the head, during the sub-step. All positions are relative to
    /// that centre.
    center_displacement: vec3<f32>,
    /// Share of the velocity that damping leaves.
    velocity_kept: f32,
    /// Displacement by gravity.
    gravity: vec3<f32>,
    /// The longest displacement relative to the head.
    max_displacement: f32,
    /// Displacement by the wind from the four corners of its cone, across an edge; for the solver `Direct` its velocity, units/s.
    wind: array<vec4<f32>, 4>,
    /// How far roots are away from the straight line between where they are at the ends of the frame: that much of the way to its end, and
    /// of those to the starts of the last frame and of the one before it.
    root_bend: vec3<f32>,
    /// The farthest that this may lead away from the line.
    root_slack: f32,
    global_stiffness: f32,
    /// Share of the strand's vertices, from the root, that the global shape reaches.
    global_range: f32,
    /// Share of the distance to the rest shape that one iteration moves, by both vertices of an edge together.
    local_stiffness: f32,
    /// Coefficient of sliding friction.
    friction: f32,
    tip_separation: f32,
    /// Share of the head's motion that the strands make at once.
    shock: f32,
    /// Not 0: the strands go to their rest pose, at rest.
    reset: u32,
    /// Guides of the section.
    guides: u32,
    /// Guides and follow strands of the section.
    strands: u32,
    /// Vertices of each strand.
    vertices: u32,
    /// The share of the frame that has passed at the end of the sub-step.
    root_share: f32,
    /// The first capsule that the section collides with.
    first_capsule: u32,
    /// The capsule after the last one.
    end_capsule: u32,
    /// Not 0: the past of a strand says nothing, since the sub-step before had another length.
    first_order: u32,
    /// Length of the sub-step, s.
    length: f32,
    /// Bending stiffness over the mass of unit length, units^4/s^2.
    bending: f32,
    /// Twist stiffness over bending stiffness.
    twist_ratio: f32,
    /// Time by which bending moments lag behind, s.
    internal_damping: f32,
    /// Rate at which still air stops hair that moves across itself, 1/s.
    drag_across: f32,
    /// The same along itself.
    drag_along: f32,
    /// Stiffness of the spring to the rest pose over mass, 1/s^2.
    pull: f32,
    /// The most rounds of Newton's method.
    rounds: u32,
    /// Which of the three places of a root is that at the start of the frame; those before it are the two before, in turns.
    root_place: u32,
    padding: f32,
}

@group(0) @binding(0) var<uniform> step: Step;
