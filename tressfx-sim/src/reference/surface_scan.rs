//! `hair.sim.surface_scan` on the CPU.

use super::surface_count::NodeSurface;

/// Vertices and triangles before each node, and, last, of all.
pub fn surface_scan(counts: &[NodeSurface]) -> Vec<[u32; 2]> {
    let mut before = [0, 0];
    let mut firsts = vec![before];
    for node in counts {
        before = [before[0] + node.edges.count_ones(), before[1] + node.triangles];
        firsts.push(before);
    }
    firsts
}
