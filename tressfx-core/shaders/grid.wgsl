// Finding one's place in a grid of threads.

/// Threads of a group of a kernel that goes through a row of things.
const GROUP: u32 = 64u;

/// Index of a thread in a grid made by `Grid::for_threads`: groups are folded into rows where one row does not hold them.
fn thread_index(group: vec3<u32>, groups: vec3<u32>, lane: u32) -> u32 {
    return (group.y * groups.x + group.x) * GROUP + lane;
}
