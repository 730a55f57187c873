// Signed distance fields of meshes, as what collides with them reads them.

/// The headers of all fields, `HEADER` words each; then the distances of the nodes of each, along x first; negative inside.
@group(0) @binding(10) var<storage, read> fields: array<u32>;

/// Words of a header.
const HEADER: u32 = 16u;
/// Where the first node is, three numbers.
const ORIGIN: u32 = 0u;
/// From one node to the next.
const CELL: u32 = 3u;
/// Nodes along x, y and z.
const NODES: u32 = 4u;
/// The distance from the surface that hair is kept at.
const MARGIN: u32 = 7u;
/// Where its distances are, in words.
const FIRST: u32 = 8u;
/// The distance from a mesh without a sound triangle.
const NO_SURFACE: f32 = 1e10;

/// The distance of a point from the surface, and its gradient, a unit vector where there is one; 0 where there is none.
struct Sample { distance: f32, normal: vec3<f32> }

fn header(field: u32, word: u32) -> f32 {
    return bitcast<f32>(fields[HEADER * field + word]);
}

/// The distance that is interpolated between the eight nodes around a point in the space of the mesh, less the margin. Beyond the outermost nodes
/// it is no more than the distance is.
fn sample(field: u32, point: vec3<f32>) -> Sample {
    let origin = vec3(header(field, ORIGIN), header(field, ORIGIN + 1u), header(field, ORIGIN + 2u));
    let cell = header(field, CELL);
    let nodes = vec3(fields[HEADER * field + NODES], fields[HEADER * field + NODES + 1u], fields[HEADER * field + NODES + 2u]);
    let end = vec3<f32>(nodes) - 1.0;
    let asked = (point - origin) / cell;
    let within = clamp(asked, vec3(0.0), end);
    let low = min(floor(within), end - 1.0);
    let share = within - low;
    let first = fields[HEADER * field + FIRST] + (u32(low.z) * nodes.y + u32(low.y)) * nodes.x + u32(low.x);
    let near = face(first, nodes.x);
    let far = face(first + nodes.x * nodes.y, nodes.x);
    let rows = mix(near, far, share.z);
    let ends = mix(rows.xz, rows.yw, share.x);
    let along_x = mix(rows.y - rows.x, rows.w - rows.z, share.y);
    let deeper = far - near;
    let along_z = mix(mix(deeper.x, deeper.y, share.x), mix(deeper.z, deeper.w, share.x), share.y);
    let gradient = vec3(along_x, ends.y - ends.x, along_z);
    let squared = dot(gradient, gradient);
    let normal = select(vec3(0.0), gradient * inverseSqrt(squared), squared > 1e-24 * cell * cell);
    var distance = mix(ends.x, ends.y, share.y);
    let beyond = cell * (asked - within);
    let beyond_squared = dot(beyond, beyond);
    // The mesh is within the box: seen from its side, what is beyond and what is within are at a right angle or more.
    if (beyond_squared > 0.0) { distance = sqrt(distance * distance + beyond_squared); }
    return Sample(distance - header(field, MARGIN), normal);
}

/// The four nodes of a face of a cell: along x, then along y.
fn face(first: u32, row: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(vec4(fields[first], fields[first + 1u], fields[first + row], fields[first + row + 1u]));
}
