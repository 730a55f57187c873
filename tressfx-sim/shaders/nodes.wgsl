// The nodes of a grid: x first, then y, then z. A corner of a cell is a number of three bits: whether it is the further one along x, y and z.

fn node_index(node: vec3<u32>, nodes: vec3<u32>) -> u32 {
    return (node.z * nodes.y + node.y) * nodes.x + node.x;
}

/// A node of an index below the number of nodes.
fn node_at(index: u32, nodes: vec3<u32>) -> vec3<u32> {
    let row = index / nodes.x;
    return vec3(index % nodes.x, row % nodes.y, row / nodes.y);
}

/// From the first node of a cell to a corner of it, 0 to 7.
fn corner_of(corner: u32) -> vec3<u32> {
    return vec3(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
}
