// Symmetric matrices, half of which is enough.

/// The diagonal, and what is beside it: yz, zx, xy.
struct Symmetric { diagonal: vec3<f32>, beside: vec3<f32> }

fn scaled_identity(scale: f32) -> Symmetric {
    return Symmetric(vec3(scale), vec3(0.0));
}

/// The product of a vector with itself, scaled.
fn outer(scale: f32, v: vec3<f32>) -> Symmetric {
    let scaled = scale * v;
    return Symmetric(scaled * v, scaled.yzx * v.zxy);
}

fn sum(a: Symmetric, b: Symmetric) -> Symmetric {
    return Symmetric(a.diagonal + b.diagonal, a.beside + b.beside);
}

fn scaled(scale: f32, m: Symmetric) -> Symmetric {
    return Symmetric(scale * m.diagonal, scale * m.beside);
}

fn trace(m: Symmetric) -> f32 {
    return m.diagonal.x + m.diagonal.y + m.diagonal.z;
}

fn times(m: Symmetric, v: vec3<f32>) -> vec3<f32> {
    return m.diagonal * v + m.beside.zxy * v.yzx + m.beside.yzx * v.zxy;
}

/// The whole matrix.
fn whole(m: Symmetric) -> mat3x3<f32> {
    return mat3x3(
        vec3(m.diagonal.x, m.beside.z, m.beside.y),
        vec3(m.beside.z, m.diagonal.y, m.beside.x),
        vec3(m.beside.y, m.beside.x, m.diagonal.z),
    );
}

/// A product that is known to be symmetric.
fn symmetric_product(a: mat3x3<f32>, b: mat3x3<f32>) -> Symmetric {
    let rows = transpose(a);
    return Symmetric(
        vec3(dot(rows[0], b[0]), dot(rows[1], b[1]), dot(rows[2], b[2])),
        vec3(dot(rows[1], b[2]), dot(rows[2], b[0]), dot(rows[0], b[1])),
    );
}

/// Half of a matrix that is known to be symmetric.
fn symmetric(m: mat3x3<f32>) -> Symmetric {
    return Symmetric(vec3(m[0].x, m[1].y, m[2].z), vec3(m[1].z, m[2].x, m[0].y));
}

/// A matrix and its transpose.
fn with_transpose(m: mat3x3<f32>) -> Symmetric {
    return Symmetric(2.0 * vec3(m[0].x, m[1].y, m[2].z), vec3(m[2].y, m[0].z, m[1].x) + vec3(m[1].z, m[2].x, m[0].y));
}

/// A pivot is never less than this share of the trace: less is rounding.
const LEAST_PIVOT: f32 = 1e-7;

/// The factors L and D of `m = L * D * transpose(L)`: the inverse of D, and what L has beside its diagonal of ones. The inverse itself would
/// not do: rounding of what it makes of the weakest direction is more than all that it makes of one that is a million times stiffer.
fn factors_of(m: Symmetric) -> Symmetric {
    let least = LEAST_PIVOT * trace(m);
    let x = 1.0 / max(m.diagonal.x, least);
    let xy = x * m.beside.z;
    let zx = x * m.beside.y;
    let y = 1.0 / max(m.diagonal.y - xy * m.beside.z, least);
    let left = m.beside.x - xy * m.beside.y;
    let yz = y * left;
    let z = 1.0 / max(m.diagonal.z - zx * m.beside.y - yz * left, least);
    return Symmetric(vec3(x, y, z), vec3(yz, zx, xy));
}

/// What a matrix of these factors takes to `v`.
fn solved(factors: Symmetric, v: vec3<f32>) -> vec3<f32> {
    let y = v.y - factors.beside.z * v.x;
    let z = v.z - factors.beside.y * v.x - factors.beside.x * y;
    let scaled = factors.diagonal * vec3(v.x, y, z);
    let before = scaled.y - factors.beside.x * scaled.z;
    return vec3(scaled.x - factors.beside.z * before - factors.beside.y * scaled.z, before, scaled.z);
}

fn solved_columns(factors: Symmetric, m: mat3x3<f32>) -> mat3x3<f32> {
    return mat3x3(solved(factors, m[0]), solved(factors, m[1]), solved(factors, m[2]));
}

/// The columns of `v x m`.
fn cross_columns(v: vec3<f32>, m: mat3x3<f32>) -> mat3x3<f32> {
    return mat3x3(cross(v, m[0]), cross(v, m[1]), cross(v, m[2]));
}
