//! FLIP against the authors' own implementation: the figures below are from their package `flip-evaluator` 1.7 (LDR, its
//! defaults), for the same pictures made by the same formulas.

use tressfx_compare::{Picture, compare};

const SIZE: [u32; 2] = [96, 64];

/// A picture by a formula.
fn picture(color: impl Fn(u32, u32) -> [u32; 3]) -> Picture {
    let places = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let bytes = places.flat_map(|(x, y)| {
        let [r, g, b] = color(x, y).map(|channel| channel as u8);
        [r, g, b, 255]
    });
    Picture::new(SIZE, bytes.collect()).unwrap()
}

fn even(color: [u32; 3]) -> Picture {
    picture(|_, _| color)
}

fn ramp(shift: u32) -> Picture {
    picture(|x, y| [2 * (x + shift), 3 * y, 255 - x - y])
}

/// Slanting lines, light on dark, much as strands are.
fn lines(shift: u32) -> Picture {
    picture(|x, y| if (3 * x + 2 * y + shift) % 17 < 3 { [230, 180, 120] } else { [25, 20, 30] })
}

fn disc(radius: u32) -> Picture {
    let inside = |x: u32, y: u32| x.abs_diff(48).pow(2) + y.abs_diff(32).pow(2) < radius * radius;
    picture(|x, y| if inside(x, y) { [200, 40, 40] } else { [90, 110, 140] })
}

/// White noise from a hash of the place.
fn noise(seed: u32) -> Picture {
    picture(|x, y| {
        let place = x.wrapping_mul(374_761_393).wrapping_add(y.wrapping_mul(668_265_263));
        let hash = place.wrapping_add(seed.wrapping_mul(2_246_822_519));
        let hash = (hash ^ (hash >> 13)).wrapping_mul(1_274_126_177);
        let hash = hash ^ (hash >> 16);
        [hash, hash >> 8, hash >> 16].map(|bits| bits & 255)
    })
}

#[test]
fn the_means_are_those_of_the_authors() {
    let pairs = [
        ("black and white", even([0; 3]), even([255; 3]), 0.967_388_3),
        ("green and blue", even([0, 255, 0]), even([0, 0, 255]), 1.0),
        ("one step of grey", even([128; 3]), even([129; 3]), 0.029_863_1),
        ("shifted ramp", ramp(0), ramp(5), 0.098_921_8),
        ("shifted lines", lines(0), lines(3), 0.302_354_0),
        ("noise", noise(1), noise(2), 0.443_336_3),
        ("larger disc", disc(20), disc(21), 0.035_923_3),
        ("lines and ramp", lines(0), ramp(0), 0.820_515_9),
    ];
    for (name, a, b, mean) in pairs {
        for (a, b) in [(&a, &b), (&b, &a)] {
            let ours = compare(a, b).unwrap().flip_mean;
            assert!((ours - mean).abs() < 2e-5, "{name}: {ours} against {mean}");
        }
    }
}

/// A ramp of 16 bits, brighter by so many of its steps.
fn deep(more: u32) -> Picture<u16> {
    let places = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let channels = places.flat_map(|(x, y)| {
        let color = [200 * x + 17 * y, 300 * y + 11 * x, 40_000 - 100 * x - 150 * y];
        let [r, g, b] = color.map(|channel| (channel + more) as u16);
        [r, g, b, u16::MAX]
    });
    Picture::new(SIZE, channels.collect()).unwrap()
}

/// For these the authors' program was given floats.
#[test]
fn the_means_of_pictures_of_sixteen_bits_are_those_of_the_authors() {
    for (more, mean) in [(40, 0.010_818_6), (90, 0.019_179_8)] {
        let ours = compare(&deep(0), &deep(more)).unwrap().flip_mean;
        assert!((ours - mean).abs() < 2e-5, "{more}: {ours} against {mean}");
    }
}
