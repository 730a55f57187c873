//! Small tools: a fixed-step integrator, and roots of one equation or of several.

/// Integrates `y' = f(t, y)` by the classical Runge-Kutta method of fourth order.
pub fn integrate<const N: usize>(
    f: impl Fn(f64, &[f64; N]) -> [f64; N],
    start: [f64; N],
    [from, to]: [f64; 2],
    steps: usize,
) -> [f64; N] {
    let h = (to - from) / steps as f64;
    let moved = |y: &[f64; N], k: &[f64; N], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    let mut y = start;
    for step in 0..steps {
        let t = from + step as f64 * h;
        let k1 = f(t, &y);
        let k2 = f(t + h / 2.0, &moved(&y, &k1, h / 2.0));
        let k3 = f(t + h / 2.0, &moved(&y, &k2, h / 2.0));
        let k4 = f(t + h, &moved(&y, &k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    y
}

/// Where `f` changes its sign between `low` and `high`, by bisection to the last bit.
///
/// # Panics
/// If `f` has the same sign at both.
pub fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = f(low) > 0.0;
    assert_ne!(sign, f(high) > 0.0, "no change of sign between {low} and {high}");
    loop {
        let middle = (low + high) / 2.0;
        if middle <= low.min(high) || middle >= low.max(high) {
            return middle;
        }
        if (f(middle) > 0.0) == sign { low = middle } else { high = middle }
    }
}

/// The first change of sign of `f` in `steps` equal parts of a range.
///
/// # Panics
/// If there is none.
pub fn first_root(f: impl Fn(f64) -> f64, [from, to]: [f64; 2], steps: usize) -> f64 {
    let at = |step: usize| from + (to - from) * step as f64 / steps as f64;
    let sign = f(from) > 0.0;
    let found = (1..=steps).find(|&step| (f(at(step)) > 0.0) != sign).expect("a change of sign");
    root(f, at(found - 1), at(found))
}

/// Where `f` comes nearest to 0 within a range in which it does so once, by ternary search.
pub fn nearest_to_zero(f: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        if f(low + third).abs() < f(high - third).abs() { high -= third } else { low += third }
    }
    (low + high) / 2.0
}

/// Derivatives of `f` by central differences: `jacobian[i][j]` is that of the value `i` by the unknown `j`.
pub fn jacobian<const N: usize>(f: &impl Fn(&[f64; N]) -> [f64; N], at: &[f64; N], size: f64) -> [[f64; N]; N] {
    let by_unknown: [[f64; N]; N] = std::array::from_fn(|unknown| {
        let moved = |by: f64| std::array::from_fn(|i| at[i] + if i == unknown { by } else { 0.0 });
        let (more, less) = (f(&moved(size)), f(&moved(-size)));
        std::array::from_fn(|value| (more[value] - less[value]) / (2.0 * size))
    });
    std::array::from_fn(|value| std::array::from_fn(|unknown| by_unknown[unknown][value]))
}

/// Solves a linear system by Gaussian elimination with pivots; also gives the determinant of the matrix.
pub fn linear<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> ([f64; N], f64) {
    let mut determinant = 1.0;
    for column in 0..N {
        let larger = |&a: &usize, &b: &usize| matrix[a][column].abs().total_cmp(&matrix[b][column].abs());
        let pivot = (column..N).max_by(larger).unwrap_or(column);
        if pivot != column {
            matrix.swap(pivot, column);
            right.swap(pivot, column);
            determinant = -determinant;
        }
        determinant *= matrix[column][column];
        for row in column + 1..N {
            let factor = matrix[row][column] / matrix[column][column];
            let pivot = matrix[column];
            matrix[row].iter_mut().zip(pivot).for_each(|(value, above)| *value -= factor * above);
            right[row] -= factor * right[column];
        }
    }
    for row in (0..N).rev() {
        let known: f64 = (row + 1..N).map(|column| matrix[row][column] * right[column]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    (right, determinant)
}

/// Solves `f = 0` by Newton's method from a guess; `None` if it does not come below `tolerance` in 30 rounds.
pub fn newton<const N: usize>(f: impl Fn(&[f64; N]) -> [f64; N], guess: [f64; N], tolerance: f64) -> Option<[f64; N]> {
    let mut at = guess;
    for _ in 0..30 {
        let value = f(&at);
        if value.iter().all(|value| value.abs() < tolerance) {
            return Some(at);
        }
        let (step, _) = linear(jacobian(&f, &at, 1e-6), value);
        at = std::array::from_fn(|i| at[i] - step[i]);
    }
    None
}
