//! How much light reaches each vertex of a groom, and from which directions. It is the shadow of the groom on itself in the
//! rest pose, computed once on the CPU. It moves with the strands.
//!
//! The groom is entered into a grid of cells as an absorbing medium, together with the skin under its roots. Light is traced
//! through the grid along the 26 directions between neighbouring cells. The share of the light that arrives is a function of
//! the direction; it is stored as a constant and a vector, as in first-order spherical harmonics. The vector is relative to
//! a frame of the strand (its tangent, and the direction in which it grows out of the skin), so that it turns with the
//! strand.

use glam::{IVec3, Vec3, Vec4};
use tressfx_core::strands::{Bounds, Strands};

/// Cells along the longest side of the groom.
const CELLS: f32 = 56.0;

/// The share of the light on a strand that is absorbed. Hair scatters most of it forwards.
const ABSORPTION: f32 = 0.3;

/// The most guides that are entered into the grid. The first ones are an even sample of all.
const MAX_GUIDES: usize = 40_000;

/// Cells around the groom: room for the skin.
const MARGIN: i32 = 8;

/// Largest radius of the balls that the skin is made of, in cells.
const MAX_SKIN_RADIUS: f32 = 3.0;

/// Optical depth of a cell that is inside the skin.
const SKIN_DEPTH: f32 = 6.0;

/// Weights of Lebedev's 26 points on a sphere: those of the axes, of the edges and of the corners of a cube.
const WEIGHTS: [f32; 3] = [1.0 / 21.0, 4.0 / 105.0, 9.0 / 280.0];

/// The visibility of each vertex of the guides, strand-major, as [`crate::StrandInfo::visibility`] describes it. `radius` is
/// the radius of a fibre in the unit of the file.
pub(crate) fn visibility(strands: &Strands, radius: f32) -> Vec<[f32; 4]> {
    let lattice = Lattice::around(strands);
    let mut medium = Medium { lattice, depth: vec![0.0; lattice.cell_count()] };
    medium.add_hair(strands, radius);
    medium.add_skin(strands);
    let light = medium.light(&lattice.cells_around(strands));
    let vertices = strands.vertices as usize;
    let local = |i: usize| {
        let [constant, vector] = lattice.sample(&light, strands.rest[i].truncate());
        in_frame(constant.w, vector.truncate(), strands.tangents[i].truncate(), strands.root_directions[i / vertices])
    };
    (0..strands.rest.len()).map(local).collect()
}

/// The vector in the frame of a strand: its parts along the tangent, along the part of `growth` that is perpendicular to it,
/// and perpendicular to both; then the constant.
fn in_frame(constant: f32, vector: Vec3, tangent: Vec3, growth: Vec3) -> [f32; 4] {
    let across = (growth - tangent * growth.dot(tangent)).normalize_or_zero();
    [vector.dot(tangent), vector.dot(across), vector.dot(tangent.cross(across)), constant]
}

/// Cubic cells around a groom.
#[derive(Clone, Copy)]
struct Lattice {
    origin: Vec3,
    cell: f32,
    size: IVec3,
}

impl Lattice {
    fn around(strands: &Strands) -> Self {
        let extent = strands.bounds.max - strands.bounds.min;
        let cell = (extent.max_element() / CELLS).max(f32::MIN_POSITIVE);
        let size = (extent / cell).ceil().as_ivec3() + 2 * MARGIN;
        Self { origin: strands.bounds.min - MARGIN as f32 * cell, cell, size }
    }

    fn cell_count(&self) -> usize {
        (self.size.x * self.size.y * self.size.z) as usize
    }

    fn index(&self, at: IVec3) -> Option<usize> {
        let inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(self.size).all();
        inside.then(|| ((at.z * self.size.y + at.y) * self.size.x + at.x) as usize)
    }

    /// The eight cells around a point and their weights in trilinear interpolation.
    fn around_point(self, point: Vec3) -> impl Iterator<Item = (usize, f32)> {
        let at = (point - self.origin) / self.cell - 0.5;
        let (low, share) = (at.floor().as_ivec3(), at - at.floor());
        (0..8).filter_map(move |corner: i32| {
            let step = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let weights = Vec3::select(step.cmpeq(IVec3::ONE), share, 1.0 - share);
            Some((self.index(low + step)?, weights.element_product()))
        })
    }

    /// For each cell, whether its light is needed: it is, around the vertices of the guides.
    fn cells_around(&self, strands: &Strands) -> Vec<bool> {
        let mut wanted = vec![false; self.cell_count()];
        for vertex in &strands.rest {
            self.around_point(vertex.truncate()).for_each(|(cell, _)| wanted[cell] = true);
        }
        wanted
    }

    fn sample(self, light: &[[Vec4; 2]], point: Vec3) -> [Vec4; 2] {
        self.around_point(point).fold([Vec4::ZERO; 2], |[constant, vector], (cell, share)| {
            [constant + light[cell][0] * share, vector + light[cell][1] * share]
        })
    }
}

/// The absorbing medium in the cells.
struct Medium {
    lattice: Lattice,
    /// Optical depth of each cell, from one side to the other.
    depth: Vec<f32>,
}

impl Medium {
    /// Adds the hair. A strand covers its width times its length, times pi/4 as the mean over all directions. The optical
    /// depth is this area divided by the area of a side of a cell.
    fn add_hair(&mut self, strands: &Strands, radius: f32) {
        let Lattice { cell, .. } = self.lattice;
        let (guides, vertices) = (strands.guides as usize, strands.vertices as usize);
        let used = guides.min(MAX_GUIDES);
        let stands_for = (1 + strands.follows) as f32 * guides as f32 / used.max(1) as f32;
        let cover = std::f32::consts::FRAC_PI_2 * radius * stands_for * ABSORPTION / (cell * cell);
        for strand in strands.rest.chunks(vertices).take(used) {
            for ends in strand.windows(2) {
                let [a, b] = [ends[0].truncate(), ends[1].truncate()];
                let steps = (a.distance(b) / (0.5 * cell)).ceil().clamp(1.0, 256.0);
                let each = cover * a.distance(b) / steps;
                for step in 0..steps as u32 {
                    let point = a.lerp(b, (step as f32 + 0.5) / steps);
                    self.lattice.around_point(point).for_each(|(cell, share)| self.depth[cell] += each * share);
                }
            }
        }
    }

    /// Adds the skin: a ball behind each root whose radius is the mean distance between roots, so that together they have no
    /// holes.
    fn add_skin(&mut self, strands: &Strands) {
        let Lattice { cell, origin, .. } = self.lattice;
        let roots = strands.rest.iter().step_by(strands.vertices as usize).map(|root| root.truncate());
        let extent = Bounds::of(roots.clone()).max - Bounds::of(roots.clone()).min;
        let area = 2.0 * (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x);
        let spacing = (area / strands.guides.max(1) as f32).sqrt();
        let radius = (spacing / cell).clamp(1.0, MAX_SKIN_RADIUS);
        let reach = radius.ceil() as i32;
        let ball: Vec<IVec3> = (-reach..=reach)
            .flat_map(|z| (-reach..=reach).flat_map(move |y| (-reach..=reach).map(move |x| IVec3::new(x, y, z))))
            .filter(|step| step.as_vec3().length() <= radius)
            .collect();
        for (root, direction) in roots.zip(&strands.root_directions).take(MAX_GUIDES) {
            let middle = root - *direction * cell * (radius + 1.0);
            let at = ((middle - origin) / cell).floor().as_ivec3();
            for index in ball.iter().filter_map(|&step| self.lattice.index(at + step)) {
                self.depth[index] = self.depth[index].max(SKIN_DEPTH);
            }
        }
    }

    /// The light that arrives in each `wanted` cell if light of strength 1 comes from every direction: `[0, 0, 0, constant]`
    /// and the vector.
    fn light(&self, wanted: &[bool]) -> Vec<[Vec4; 2]> {
        let mut light = vec![[Vec4::ZERO; 2]; self.depth.len()];
        let mut passed = vec![0.0f32; self.depth.len()];
        let steps = (0..27).map(|i| IVec3::new(i % 3, i / 3 % 3, i / 9) - 1).filter(|&step| step != IVec3::ZERO);
        for step in steps {
            let weight = WEIGHTS[step.abs().element_sum() as usize - 1];
            let towards = -step.as_vec3().normalize();
            self.trace(step, &mut passed);
            for ((light, &passed), _) in light.iter_mut().zip(&passed).zip(wanted).filter(|(_, wanted)| **wanted) {
                let arriving = weight * (-passed).exp();
                light[0].w += arriving;
                light[1] += (3.0 * arriving * towards).extend(0.0);
            }
        }
        light
    }

    /// The optical depth that light has passed when it reaches each cell along `step`.
    fn trace(&self, step: IVec3, passed: &mut [f32]) {
        let size = self.lattice.size;
        let length = step.as_vec3().length();
        let back = ((step.z * size.y + step.y) * size.x + step.x) as isize;
        // Cells are visited so that the one before a cell, in the direction of the light, is done first.
        let along = |size: i32, step: i32, i: i32| if step < 0 { size - 1 - i } else { i };
        for z in (0..size.z).map(|z| along(size.z, step.z, z)) {
            for y in (0..size.y).map(|y| along(size.y, step.y, y)) {
                let row = ((z * size.y + y) * size.x) as usize;
                let row_before = (0..size.z).contains(&(z - step.z)) && (0..size.y).contains(&(y - step.y));
                for x in (0..size.x).map(|x| along(size.x, step.x, x)) {
                    let at = row + x as usize;
                    passed[at] = if row_before && (0..size.x).contains(&(x - step.x)) {
                        let before = at.wrapping_add_signed(-back);
                        passed[before] + 0.5 * (self.depth[before] + self.depth[at]) * length
                    } else {
                        0.0
                    };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use tressfx_core::asset::{AssetFormat, HairAsset};
    use tressfx_core::strands::StrandOptions;

    use super::*;

    /// Straight strands that stand on the square 0..1 x 0..1 and reach to the height 1.
    fn brush(per_side: u32) -> Strands {
        let place = |i: u32| (i as f32 + 0.5) / per_side as f32;
        let strands = (0..per_side * per_side).map(|i| (place(i % per_side), place(i / per_side)));
        let points = strands.flat_map(|(x, z)| (0..16).map(move |i| [x, i as f32 / 15.0, z])).collect();
        let asset = HairAsset::new("brush", AssetFormat::Builtin, points, vec![16; (per_side * per_side) as usize]);
        Strands::new(&asset, &StrandOptions { shuffle: false, ..StrandOptions::default() }).unwrap()
    }

    fn at(strands: &Strands, visibility: &[[f32; 4]], strand: usize, vertex: usize) -> [f32; 4] {
        visibility[strand * strands.vertices as usize + vertex]
    }

    #[test]
    fn light_reaches_tips_and_edges_and_not_the_roots_in_the_middle() {
        let strands = brush(20);
        let visibility = visibility(&strands, 0.02);
        let (middle, edge) = (10 * 20 + 10, 10 * 20);
        let [root, tip] = [1, 15].map(|vertex| at(&strands, &visibility, middle, vertex));
        assert!(tip[3] > 0.35 && tip[3] < 0.7, "half of the sky is open: {tip:?}");
        assert!(root[3] < 0.5 * tip[3], "{root:?}");
        assert!(tip[0] > 0.3, "from along the strand: {tip:?}");
        assert!(at(&strands, &visibility, edge, 8)[3] > 1.5 * at(&strands, &visibility, middle, 8)[3]);
        assert!(visibility.iter().flatten().all(|x| x.is_finite() && x.abs() <= 1.6));
    }

    #[test]
    fn a_single_strand_is_lit_from_everywhere_but_the_skin() {
        let strands = brush(1);
        let visibility = visibility(&strands, 1e-5);
        let tip = at(&strands, &visibility, 0, 15);
        assert!(tip[3] > 0.9 && tip[0].abs() < 0.2, "{tip:?}");
    }

    #[test]
    fn the_frame_gives_the_vector_back() {
        let (tangent, growth) = (Vec3::new(0.0, -0.8, 0.6), Vec3::Z);
        let vector = Vec3::new(0.3, -0.2, 0.5);
        let [a, b, c, constant] = in_frame(0.7, vector, tangent, growth);
        let across = (growth - tangent * growth.dot(tangent)).normalize();
        let back = tangent * a + across * b + tangent.cross(across) * c;
        assert!(back.distance(vector) < 1e-6 && constant == 0.7);
        assert_eq!(in_frame(0.7, vector, Vec3::Z, growth), [0.5, 0.0, 0.0, 0.7]);
    }
}
