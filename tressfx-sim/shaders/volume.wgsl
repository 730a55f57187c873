// Hair against hair: a grid that is fixed to the head, and where a point is in it.

struct Volume {
    /// The first node, in the space of the head, relative to the centre of the groom.
    origin: vec3<f32>,
    /// From node to node.
    cell: f32,
    /// Nodes along x, y and z, 2 at least.
    nodes: vec3<u32>,
    /// Whole numbers that a unit of length of one strand counts as.
    unit_mass: f32,
    /// The speed that momentum is a share of, units/s.
    fastest: f32,
    /// The rate at which strands take on the velocity of those around them, 1/s.
    friction: f32,
    /// How fast compression spreads, units/s.
    sound_speed: f32,
    padding: f32,
}

/// What a node has come to: how the pressure grows along x, y and z, and the mean velocity of the strands around it, relative to the head and in
/// its space.
struct VolumeNode { slope: vec3<f32>, velocity: vec3<f32> }

@group(0) @binding(1) var<uniform> volume: Volume;

/// The cell that a point is in: its first node, and how far through the cell the point is. None where it is outside of the grid.
struct Place { node: vec3<u32>, share: vec3<f32>, is_inside: bool }

fn place_of(point: vec3<f32>) -> Place {
    let scaled = (point - volume.origin) / volume.cell;
    // Also false where it is no number.
    let is_inside = all(scaled >= vec3(0.0)) && all(scaled < vec3<f32>(volume.nodes - 1u));
    let node = floor(select(vec3(0.0), scaled, is_inside));
    return Place(vec3<u32>(node), scaled - node, is_inside);
}

/// The weight of a corner: trilinear.
fn weight_of(share: vec3<f32>, corner: vec3<u32>) -> f32 {
    let along = select(1.0 - share, share, corner == vec3(1u));
    return along.x * along.y * along.z;
}
