// How a hair fibre scatters light: a dielectric cylinder with tilted scales and pigment. `scattering.rs` has the model and makes the table.

struct Fibre {
    tangent: vec3<f32>,
    // Radians by which the scales tilt.
    tilt: f32,
    // For a radius of the fibre.
    absorption: vec3<f32>,
    // Of the lobe that is mirrored.
    variance: f32,
    // How much of what fibres behind it give back is seen.
    multiple: f32,
}

// Lobes of a white fibre, and the radii that light of the last three goes within it.
struct Lobes {
    // Along the fibre the first is `e`: what is caught between scales, and leaves evenly.
    white: vec4<f32>,
    paths: vec3<f32>,
    // The square of what light is divided by.
    g_square: f32,
}

// Over the angle around the fibre and the cosine of `theta_d`; behind them those over the angle from the tangent, and pairs over the cosine of `theta`. Eight half floats each.
@group(0) @binding(6) var<storage, read> fibre_table: array<vec4<u32>>;

const PI: f32 = 3.14159265;
const COLUMNS: u32 = 64u;
const ROWS: u32 = 16u;
const POLES: u32 = 64u;

// Of R, TT, TRT and what is mirrored more often: the variance in that of R, and by how many tilts light and eye are turned each.
const VARIANCES: vec4<f32> = vec4(1.0, 0.25, 4.0, 4.0);
const TURNS: vec4<f32> = vec4(1.0, -0.5, -1.5, 0.0);

fn unpacked(index: u32) -> array<vec4<f32>, 2> {
    let all = fibre_table[index];
    let low = vec4(unpack2x16float(all.x), unpack2x16float(all.y));
    return array(low, vec4(unpack2x16float(all.z), unpack2x16float(all.w)));
}

fn lobes_at(index: u32) -> Lobes {
    let all = unpacked(index);
    return Lobes(all[0], all[1].xyz, all[1].w);
}

fn mix_lobes(a: Lobes, b: Lobes, share: f32) -> Lobes {
    return Lobes(mix(a.white, b.white, share), mix(a.paths, b.paths, share), mix(a.g_square, b.g_square, share));
}

// A place for an angle from 0 to PI, 0 to 1.
fn place(cosine: f32) -> f32 {
    let s = sqrt(max(0.0, 0.5 - 0.5 * cosine));
    let c = sqrt(max(0.0, 0.5 + 0.5 * cosine));
    return s / (s + c);
}

fn lobes_around(cos_phi: f32, cos_theta_d: f32) -> Lobes {
    let x = place(cos_phi) * f32(COLUMNS - 1u);
    let y = cos_theta_d * f32(ROWS - 1u);
    let column = min(u32(x), COLUMNS - 2u);
    let row = min(u32(y), ROWS - 2u);
    let first = row * COLUMNS + column;
    let share = x - f32(column);
    let low = mix_lobes(lobes_at(first), lobes_at(first + 1u), share);
    let high = mix_lobes(lobes_at(first + COLUMNS), lobes_at(first + COLUMNS + 1u), share);
    return mix_lobes(low, high, y - f32(row));
}

fn lobes_along(sin_theta: f32) -> Lobes {
    let at = place(sin_theta) * f32(POLES - 1u);
    let first = min(u32(at), POLES - 2u);
    let index = ROWS * COLUMNS + first;
    return mix_lobes(lobes_at(index), lobes_at(index + 1u), at - f32(first));
}

// `exp(-x)` times the modified Bessel function of order 0: Abramowitz and Stegun 9.8.1 and 9.8.2.
fn bessel(x: f32) -> f32 {
    if x < 3.75 {
        let t = x * x / 14.0625;
        let sum = 1.0 + t * (3.5156229 + t * (3.0899424 + t * (1.2067492 + t * (0.2659732 + t * (0.0360768 + t * 0.0045813)))));
        return exp(-x) * sum;
    }
    let t = 3.75 / x;
    let high = 0.00916281 + t * (-0.02057706 + t * (0.02635537 + t * (-0.01647633 + t * 0.00392377)));
    return (0.39894228 + t * (0.01328592 + t * (0.00225319 + t * (-0.00157565 + t * high)))) * inverseSqrt(x);
}

// Angles as sine and cosine.
fn turned(angle: vec2<f32>, by: vec2<f32>) -> vec2<f32> {
    return vec2(angle.x * by.y + angle.y * by.x, angle.y * by.y - angle.x * by.x);
}

// The lobe along the fibre.
fn lobe(variance: f32, a: vec2<f32>, b: vec2<f32>) -> f32 {
    let across = abs(a.y * b.y);
    let exponent = min((across - a.x * b.x - 1.0) / variance, 0.0);
    return exp(exponent) * bessel(across / variance) / (variance * (1.0 - exp(-2.0 / variance)));
}

fn colored(lobes: vec4<f32>, paths: vec3<f32>, absorption: vec3<f32>) -> vec3<f32> {
    return lobes.x + lobes.y * exp(-absorption * paths.x) + lobes.z * exp(-absorption * paths.y)
        + lobes.w * exp(-absorption * paths.z);
}

fn theta(fibre: Fibre, direction: vec3<f32>) -> vec2<f32> {
    let sine = clamp(dot(fibre.tangent, direction), -1.0, 1.0);
    return vec2(sine, sqrt(max(0.0, 1.0 - sine * sine)));
}

// What light that meets a fibre has in common for all directions of the eye.
struct Passed {
    // The share that goes on, and what layers behind give back.
    on: vec3<f32>,
    behind: vec3<f32>,
    // How much of each lobe leaves a white fibre.
    white: vec4<f32>,
}

// How much of light comes back from endless layers, each of which passes `on` and mirrors `back`.
fn bulk(on: vec3<f32>, back: vec3<f32>) -> vec3<f32> {
    let sum = 1.0 + back * back - on * on;
    return (sum - sqrt(max(vec3(0.0), sum * sum - 4.0 * back * back))) / (2.0 * back);
}

fn passed(fibre: Fibre, cos_theta: f32) -> Passed {
    let at = cos_theta * f32(ROWS - 1u);
    let row = min(u32(at), ROWS - 2u);
    let first = COLUMNS * ROWS + POLES + 2u * row;
    let low = unpacked(first);
    let high = unpacked(first + 2u);
    let share = at - f32(row);
    let paths = mix(unpacked(first + 1u)[1].xyz, unpacked(first + 3u)[1].xyz, share);
    let white_on = mix(low[0], high[0], share);
    var white_back = mix(low[1], high[1], share);
    // A white fibre loses nothing, whatever half floats round: `bulk` takes the root of what would be lost.
    white_back.x = max(0.0, 1.0 - dot(white_on, vec4(1.0)) - dot(white_back.yzw, vec3(1.0)));
    let on = colored(white_on, paths, fibre.absorption);
    let back = max(colored(white_back, paths, fibre.absorption), vec3(1e-6));
    let behind = max(bulk(on, back) - back, vec3(0.0));
    return Passed(on, fibre.multiple * behind, white_on + white_back);
}

fn power(base: vec3<f32>, exponent: f32) -> vec3<f32> {
    return exp(exponent * log(max(base, vec3(1e-6))));
}

// Fibres that leave so much of light where each takes `alpha`.
fn fibres(share: f32, alpha: f32) -> f32 {
    return log(min(share, 1.0)) / log(1.0 - clamp(alpha, 1e-4, 0.999));
}

// Radiance towards `eye` of a fibre in light from `light` that a white matte surface facing it would have a radiance of 1 in, behind so many fibres.
fn scatter(fibre: Fibre, eye: vec3<f32>, light: vec3<f32>, fibres: f32) -> vec3<f32> {
    let i = theta(fibre, light);
    let r = theta(fibre, eye);
    let cos_phi = clamp((dot(eye, light) - i.x * r.x) / max(i.y * r.y, 1e-6), -1.0, 1.0);
    let cos_theta_d = sqrt(clamp(0.5 + 0.5 * dot(i, r), 0.0, 1.0));
    let around = lobes_around(cos_phi, cos_theta_d);
    let along_i = lobes_along(i.x);
    let along_r = lobes_along(r.x);
    let before = passed(fibre, i.y);
    // Light that was scattered on its way comes from around the light.
    var lobes = mix(before.white / (2.0 * PI), around.white, exp(-fibres));
    let spread = VARIANCES[1] * fibres;
    for (var p = 0u; p < 4u; p++) {
        let by = TURNS[p] * fibre.tilt;
        let turn = vec2(sin(by), cos(by));
        lobes[p] *= lobe((VARIANCES[p] + spread) * fibre.variance, turned(i, turn), turned(r, turn));
    }
    lobes.y += along_i.white.x * along_r.white.x / (2.0 * PI);
    let back = lobe((2.0 * VARIANCES[1] + VARIANCES[2] + spread) * fibre.variance, i, r) * (1.0 + cos_phi) / (2.0 * PI);
    let single = colored(lobes, around.paths, fibre.absorption);
    let scale = PI * i.y * inverseSqrt(along_i.g_square * along_r.g_square);
    return scale * power(before.on, fibres) * (single + back * before.behind);
}

// Radiance towards `eye` in light of radiance 1 from everywhere, behind so many fibres.
fn under_sky(fibre: Fibre, eye: vec3<f32>, fibres: f32) -> vec3<f32> {
    let r = theta(fibre, eye);
    let along = lobes_along(r.x);
    let white = along.white.yzw;
    let mirrored = max(0.0, 1.0 - white.x - white.y - white.z);
    let single = colored(vec4(mirrored, white), along.paths, fibre.absorption);
    let before = passed(fibre, r.y);
    return power(before.on, fibres) * (single + before.behind);
}
