// The mesh that a field is made of, and the grid of the field. Within these kernels lengths are in cells, and places are from the first
// node: numbers are near 1, whatever the unit of the mesh.

/// What is the same whenever a field is made.
struct FieldBuild {
    /// Nodes along x, y and z.
    nodes: vec3<u32>,
    triangles: u32,
    /// Where the vertices lie, in floats: the first, and from one to the next.
    first_float: u32,
    stride: u32,
    /// Where its header is among all fields, in words,
    header: u32,
    /// and where its distances are.
    first_word: u32,
    /// Edges that no other triangle closes.
    open_edges: u32,
    /// Bits of the index of a triangle.
    index_bits: u32,
    /// Parts of a cell that crossings are exact to.
    parts: i32,
    /// How far the flood looks in this pass, nodes.
    reach: u32,
}

/// What `field_grid` has found: a node is at `origin + cell * (x, y, z)`.
struct Grid { origin: vec3<f32>, cell: f32 }

struct Triangle { a: vec3<f32>, b: vec3<f32>, c: vec3<f32> }

@group(0) @binding(0) var<uniform> build: FieldBuild;
@group(0) @binding(1) var<storage, read> vertices: array<f32>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;
@group(0) @binding(3) var<storage, read> grid: Grid;

/// A vertex further away than this is none: squares stay finite.
const FARTHEST: f32 = 1e15;
/// Triangles of which less than this is area, over the square of the square of the longest edge, are as good as segments.
const FLAT: f32 = 1e-10;

/// A vertex in the unit of the mesh.
fn vertex_at(index: u32) -> vec3<f32> {
    let at = build.first_float + index * build.stride;
    return vec3(vertices[at], vertices[at + 1u], vertices[at + 2u]);
}

/// A triangle in the unit of the mesh.
fn mesh_triangle(index: u32) -> Triangle {
    return Triangle(
        vertex_at(indices[3u * index]), vertex_at(indices[3u * index + 1u]), vertex_at(indices[3u * index + 2u]));
}

/// Whether its vertices are numbers, and near enough.
fn is_sound(triangle: Triangle) -> bool {
    return is_near(triangle.a) && is_near(triangle.b) && is_near(triangle.c);
}

/// Looks at the bits: compilers may assume that comparisons never see a NaN.
fn is_near(v: vec3<f32>) -> bool {
    return all((bitcast<vec3<u32>>(v) & vec3(0x7fffffffu)) < vec3(bitcast<u32>(FARTHEST)));
}

/// The same triangle in cells from the first node.
fn in_cells(triangle: Triangle) -> Triangle {
    return Triangle(to_cells(triangle.a), to_cells(triangle.b), to_cells(triangle.c));
}

fn to_cells(vertex: vec3<f32>) -> vec3<f32> {
    return (vertex - grid.origin) / grid.cell;
}

fn node_count() -> u32 {
    return build.nodes.x * build.nodes.y * build.nodes.z;
}

/// The point of a triangle that is nearest to a point. Right for triangles without an area too.
fn nearest_on(triangle: Triangle, point: vec3<f32>) -> vec3<f32> {
    let ab = triangle.b - triangle.a;
    let ac = triangle.c - triangle.a;
    let normal = cross(ab, ac);
    let squared = dot(normal, normal);
    if (is_wide(triangle, squared)) {
        let foot = point - normal * (dot(point - triangle.a, normal) / squared);
        let inside = vec3(
            dot(cross(ab, foot - triangle.a), normal),
            dot(cross(triangle.c - triangle.b, foot - triangle.b), normal),
            dot(cross(triangle.a - triangle.c, foot - triangle.c), normal));
        if (all(inside >= vec3(0.0))) { return foot; }
    }
    var nearest = nearest_on_segment(triangle.a, triangle.b, point);
    nearest = nearer(point, nearest, nearest_on_segment(triangle.b, triangle.c, point));
    return nearer(point, nearest, nearest_on_segment(triangle.c, triangle.a, point));
}

/// Whether a triangle has a normal; `squared` is four times the square of its area.
fn is_wide(triangle: Triangle, squared: f32) -> bool {
    let ab = triangle.b - triangle.a;
    let bc = triangle.c - triangle.b;
    let ca = triangle.a - triangle.c;
    let longest = max(dot(ab, ab), max(dot(bc, bc), dot(ca, ca)));
    return squared > FLAT * longest * longest;
}

fn nearest_on_segment(a: vec3<f32>, b: vec3<f32>, point: vec3<f32>) -> vec3<f32> {
    let edge = b - a;
    let squared = dot(edge, edge);
    let share = select(0.0, clamp(dot(point - a, edge) / squared, 0.0, 1.0), squared > 0.0);
    return a + share * edge;
}

fn nearer(point: vec3<f32>, one: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    return select(one, other, squared_distance(point, other) < squared_distance(point, one));
}

fn squared_distance(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return dot(a - b, a - b);
}
