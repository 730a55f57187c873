// What the kernels of both solvers count.

struct Counts {
    /// Strands that went back to their rest pose because they had become non-finite.
    non_finite: atomic<u32>,
    /// Strands of a section that may touch a collider in this sub-step: `direct` leaves them to `direct_near`.
    near: atomic<u32>,
}
