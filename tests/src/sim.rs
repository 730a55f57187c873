//! What the tests of the simulation share: a simulation with its backend, grooms, motions, distances.

use std::path::PathBuf;

use glam::{DVec3, Quat, Vec3, Vec4};
use tressfx_asset::builtin::Builtin;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::Run;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::{StrandOptions, Strands, StrandsError, relative_to};
use tressfx_core::view::Pose;
use tressfx_sim::step::Step;
use tressfx_sim::{
    CapsuleMotion, Collider, HairSim, SectionDesc, SimParams, Solver, Stage, StepInput, StepReport, Wind,
};

/// A simulation and the GPU that it runs on.
pub struct Rig {
    /// The GPU.
    pub backend: Box<dyn Run>,
    /// The simulation.
    pub sim: HairSim,
    /// What it simulates.
    pub strands: Vec<Strands>,
    /// What moves with the head and is collided with in every frame that has no colliders of its own.
    pub capsules: Vec<Capsule>,
}

impl Rig {
    /// A simulation of these sections, which the published method moves.
    ///
    /// # Panics
    /// If the simulation cannot be made.
    pub fn new(mut backend: Box<dyn Run>, sections: Vec<(Strands, SimParams)>, capsules: &[Capsule]) -> Self {
        let descs: Vec<_> = sections
            .iter()
            .map(|(strands, params)| SectionDesc::new(strands, params.clone()).with_solver(Solver::TressFx))
            .collect();
        let (sim, list) = Self::simulation(&mut *backend, &descs, capsules.len());
        backend.run(&list).expect("the uploads run");
        let strands = sections.into_iter().map(|(strands, _)| strands).collect();
        Self { backend, sim, strands, capsules: capsules.to_vec() }
    }

    /// The same of one section whose roots have transforms of their own.
    ///
    /// # Panics
    /// If the simulation cannot be made.
    pub fn with_own_roots(mut backend: Box<dyn Run>, strands: Strands, params: SimParams) -> Self {
        let desc = SectionDesc::new(&strands, params).with_solver(Solver::TressFx).with_own_roots();
        let (sim, list) = Self::simulation(&mut *backend, &[desc], 0);
        backend.run(&list).expect("the uploads run");
        Self { backend, sim, strands: vec![strands], capsules: Vec::new() }
    }

    /// A simulation of one section that this solver moves.
    ///
    /// # Panics
    /// If the simulation cannot be made.
    pub fn with_solver(backend: Box<dyn Run>, strands: Strands, params: SimParams, solver: Solver) -> Self {
        Self::with_colliders(backend, strands, params, solver, &[], 0)
    }

    /// The same with these capsules on the head, and room for `most` colliders in a frame.
    ///
    /// # Panics
    /// If the simulation cannot be made.
    pub fn with_colliders(
        mut backend: Box<dyn Run>,
        strands: Strands,
        params: SimParams,
        solver: Solver,
        capsules: &[Capsule],
        most: usize,
    ) -> Self {
        let desc = SectionDesc::new(&strands, params).with_solver(solver);
        let (sim, list) = Self::simulation(&mut *backend, &[desc], most);
        backend.run(&list).expect("the uploads run");
        Self { backend, sim, strands: vec![strands], capsules: capsules.to_vec() }
    }

    fn simulation(backend: &mut dyn Run, descs: &[SectionDesc], most: usize) -> (HairSim, PassList) {
        let mut list = PassList::new();
        (HairSim::new(backend, &mut list, descs, most).expect("the simulation is made"), list)
    }

    /// Runs what `record` records.
    ///
    /// # Panics
    /// If the backend fails.
    pub fn run<T>(&mut self, record: impl FnOnce(&mut HairSim, &mut PassList) -> T) -> T {
        let mut list = PassList::new();
        let result = record(&mut self.sim, &mut list);
        self.backend.run(&list).expect("the list runs");
        result
    }

    /// Runs a frame.
    ///
    /// # Panics
    /// If the input is refused or the backend fails.
    pub fn frame(&mut self, input: &StepInput) -> StepReport {
        let with_head = Collider::all_with_head(&self.capsules);
        let colliders = if input.colliders.is_empty() { &with_head } else { input.colliders };
        self.run(|sim, list| sim.step(list, &StepInput { colliders, ..*input })).expect("the input is fine")
    }

    /// Runs a motion for `seconds` at a frame rate, after a first frame of no time at its beginning.
    pub fn play(&mut self, motion: &Motion, seconds: f64, fps: u32) {
        self.frame(&motion.input(0.0, 0.0));
        let frames = (seconds * f64::from(fps)).round() as u32;
        for frame in 1..=frames {
            self.frame(&motion.input(f64::from(frame) / f64::from(fps), 1.0 / f64::from(fps)));
        }
    }

    /// Positions of all strands of a section relative to the centre of the groom, strand-major.
    pub fn positions(&mut self, section: usize) -> Vec<Vec4> {
        let tickets = self.run(|sim, list| sim.read_positions(list));
        self.read(section, tickets[section])
    }

    /// Positions of all strands of a section in the world, strand-major.
    pub fn world(&mut self, section: usize) -> Vec<Vec4> {
        let pose = self.sim.pose();
        let to_world = |position: &Vec4| pose.transform(position.truncate()).extend(position.w);
        self.positions(section).iter().map(to_world).collect()
    }

    /// Rest pose of the guides of a section relative to the centre of the groom, strand-major.
    pub fn rest(&self, section: usize) -> Vec<Vec4> {
        relative_to(self.sim.center(), &self.strands[section].rest)
    }

    /// Its capsules as kernels see them: relative to the centre of the groom, and still as the head sees them.
    pub fn centered(&self) -> Vec<(Capsule, CapsuleMotion)> {
        let center = self.sim.center();
        let relative = |capsule: &Capsule| Capsule { a: capsule.a - center, b: capsule.b - center, ..*capsule };
        self.capsules.iter().map(|capsule| (relative(capsule), CapsuleMotion::STILL)).collect()
    }

    /// Runs one kernel of all sections, with these steps for the first section and all capsules.
    pub fn stage(&mut self, step: &Step, stage: Stage) {
        let capsules = self.centered();
        let step = step.with_capsules(0, capsules.len() as u32);
        self.run(|sim, list| {
            sim.record_capsules(list, &capsules).expect("as many as it was made for");
            sim.record_step(list, 0, &step);
            sim.record_stage(list, stage);
        });
    }

    /// Positions of the guides of a section one sub-step ago, strand-major.
    pub fn previous(&mut self, section: usize) -> Vec<Vec4> {
        let tickets = self.run(|sim, list| sim.read_previous(list));
        self.read(section, tickets[section])
    }

    /// Tangents of all strands of a section, strand-major.
    pub fn tangents(&mut self, section: usize) -> Vec<Vec4> {
        let buffers = self.sim.buffers()[section];
        let bytes = 16 * u64::from(buffers.shape.strand_vertices());
        let ticket = self.run(|_, list| list.read_buffer(buffers.tangents, 0, bytes));
        self.read(section, ticket)
    }

    /// Strands that were reset because they had become non-finite.
    ///
    /// # Panics
    /// If the backend fails.
    pub fn non_finite(&mut self) -> u32 {
        let ticket = self.run(|sim, list| sim.read_non_finite(list));
        bytemuck::pod_read_unaligned(&self.backend.read(ticket).ready().expect("the list has run"))
    }

    fn read(&mut self, section: usize, ticket: Ticket) -> Vec<Vec4> {
        let bytes = self.backend.read(ticket).ready().expect("the list has run");
        self.strands[section].deinterleave(&bytemuck::pod_collect_to_vec::<u8, Vec4>(&bytes))
    }
}

/// A motion of the head, sized for a groom.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// Metres to each side, three times a second.
    pub shake: f32,
    /// Radians to each side, once a second, about y.
    pub turn: f32,
    /// The wind.
    pub wind: Option<Wind>,
    /// Metres that a unit of the file stands for.
    pub metres_per_unit: f32,
    /// How far into its swings it begins, s.
    pub start: f64,
}

impl Motion {
    /// A head that stays where it is.
    pub fn still(strands: &Strands) -> Self {
        Self { metres_per_unit: strands.metres_per_unit, ..Self::default() }
    }

    /// A head that is turned.
    pub fn turning(strands: &Strands) -> Self {
        Self { turn: 0.5, ..Self::still(strands) }
    }

    /// A head that is shaken and turned, in a wind.
    pub fn wild(strands: &Strands) -> Self {
        let wind = Some(Wind::new(Vec3::new(2.0, 0.3, -1.0)));
        Self { shake: 0.04, wind, ..Self::turning(strands) }
    }

    /// The pose of the head at a time in seconds.
    pub fn head(&self, seconds: f64) -> Pose {
        let swing = |hertz: f64| (std::f64::consts::TAU * hertz * (self.start + seconds)).sin() as f32;
        let rotation = if self.turn == 0.0 { Quat::IDENTITY } else { Quat::from_rotation_y(self.turn * swing(1.0)) };
        Pose { rotation, translation: Vec3::X * (self.shake * swing(3.0) / self.metres_per_unit) }
    }

    /// The input of a frame that ends at a time.
    pub fn input(&self, seconds: f64, dt: f64) -> StepInput<'static> {
        StepInput { wind: self.wind, ..StepInput::new(dt, self.head(seconds)) }
    }
}

/// A small generator of numbers from 0 to 1; the same seed gives the same numbers.
pub struct Random(u64);

impl Random {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// The next number from -1 to 1 (xorshift64*, Marsaglia 2003, Vigna 2016).
    pub fn signed(&mut self) -> f32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    /// A vector of three.
    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// Random curved strands of about 20 cm on a sphere of 10 cm, in metres.
///
/// # Panics
/// If no strands can be made of so many vertices.
pub fn random_strands(guides: u32, vertices: u32, follows: u32, seed: u64) -> Strands {
    strands_of(random_asset(guides, vertices, seed), follows)
}

/// The asset of [`random_strands`].
pub fn random_asset(guides: u32, vertices: u32, seed: u64) -> HairAsset {
    let mut random = Random::new(seed);
    let mut points = Vec::new();
    for _ in 0..guides {
        let mut direction = (random.vector() + Vec3::Y * 0.2).normalize_or(Vec3::Y);
        let mut point = direction * 0.1;
        for _ in 0..vertices {
            points.push(point.to_array());
            let length = 0.2 / (vertices - 1) as f32 * (1.0 + 0.5 * random.signed());
            direction = (direction + 0.4 * random.vector()).normalize_or(Vec3::Y);
            point += direction * length;
        }
    }
    HairAsset::new(format!("random {seed}"), AssetFormat::Builtin, points, vec![vertices; guides as usize])
}

/// Strands of an asset, with follow strands that spread towards the tip.
///
/// # Panics
/// If the asset is refused.
pub fn strands_of(asset: HairAsset, follows: u32) -> Strands {
    let options = StrandOptions { follows: Some(follows), tip_separation: 1.5, ..StrandOptions::default() };
    Strands::new(&asset, &options).expect("the asset is fine")
}

/// The smaller of two: built-in grooms keep their look with fewer strands, and tests run on two cores.
///
/// # Panics
/// If there is no such groom.
pub fn builtin(name: &str, strands: u32) -> Strands {
    let builtin = Builtin { strands, ..name.parse().expect("a built-in groom") };
    strands_of(builtin.asset(), 0)
}

/// The real grooms in the folder that TRESSFX_ASSETS names; says so and gives none without it.
pub const REAL: [&str; 6] = [
    "tressfx41_ratboy/Ratboy_mohawk.tfx",
    "sintel_lite/GEO-sintel_hair_emit.002-sintel_hair.tfx",
    "tressfx31_testhair1/TestHair1.tfx",
    "fibermesh_text_tfx/Fibermesh2_mohi0.3k_Curves.tfx",
    "fibermesh_text_tfx/Fibermesh2_hair1k_Curves.tfx",
    "unity_cube_hair_obj/Cube_Hair.obj",
];

/// A real groom of [`REAL`]; `None`, visibly, where TRESSFX_ASSETS is not set.
///
/// # Panics
/// If the file cannot be read.
pub fn real(path: &str) -> Option<Strands> {
    Some(strands_of(read(path)?, 0))
}

fn read(path: &str) -> Option<HairAsset> {
    let Some(folder) = std::env::var_os("TRESSFX_ASSETS").map(PathBuf::from) else {
        crate::suite::say_skipped(path, "TRESSFX_ASSETS is not set");
        return None;
    };
    Some(tressfx_asset::read(folder.join(path)).expect("the groom reads"))
}

/// A real groom of [`REAL`], of which no more than so many strands; `None`, visibly, where TRESSFX_ASSETS is not set.
///
/// # Panics
/// If the file cannot be read.
pub fn real_part(path: &str, most: u32) -> Option<Strands> {
    let options = StrandOptions { follows: Some(0), ..StrandOptions::default() };
    Some(part_of(&read(path)?, most, &options).expect("the asset is fine"))
}

/// Strands of an asset, or an even sample of so many, in the unit that the whole has.
///
/// # Errors
/// Those of [`Strands::new`].
pub fn part_of(asset: &HairAsset, most: u32, options: &StrandOptions) -> Result<Strands, StrandsError> {
    let all = Strands::new(asset, options)?;
    if all.guides <= most {
        return Ok(all);
    }
    let options = StrandOptions { metres_per_unit: Some(all.metres_per_unit), ..options.clone() };
    Strands::new(&sampled(asset, most), &options)
}

/// So many strands of an asset, evenly through the file.
fn sampled(asset: &HairAsset, count: u32) -> HairAsset {
    let strands = asset.counts.len();
    let starts: Vec<usize> = asset
        .counts
        .iter()
        .scan(0, |start, &count| {
            *start += count as usize;
            Some(*start - count as usize)
        })
        .collect();
    let chosen: Vec<usize> = (0..count as usize).map(|i| i * strands / count as usize).collect();
    let of = |strand: usize| starts[strand]..starts[strand] + asset.counts[strand] as usize;
    let points = chosen.iter().flat_map(|&strand| asset.points[of(strand)].iter().copied()).collect();
    let counts = chosen.iter().map(|&strand| asset.counts[strand]).collect();
    let masses = asset
        .inverse_mass
        .as_ref()
        .map(|masses| chosen.iter().flat_map(|&strand| masses[of(strand)].to_vec()).collect());
    let sample = HairAsset::new(asset.name.clone(), asset.format, points, counts);
    HairAsset {
        inverse_mass: masses,
        placement: asset.placement,
        both_ends_immovable: asset.both_ends_immovable,
        ..sample
    }
}

/// Roundings of a coordinate that do not count as an error.
const ROUNDINGS: f64 = 4.0;
/// Roundings of a coordinate that the edges of a strand must have on average for f32 to know their directions.
const RESOLVED: f64 = 100.0;

/// For every strand the largest distance between GPU and reference, as a share of its length; ascending.
///
/// Rounding is absolute: at 1 m from the centre an f32 is no better than 6e-8 m. So a few roundings of the coordinate do not
/// count, and strands of which f32 cannot tell where their edges point only have to be finite; the mohawk has one of 7e-6 m.
pub fn strand_errors(strands: &Strands, gpu: &[Vec4], reference: &[DVec3]) -> Vec<f64> {
    let vertices = strands.vertices as usize;
    let lengths = lengths(strands);
    let pairs = gpu.chunks(vertices).zip(reference.chunks(vertices)).enumerate();
    let mut errors: Vec<f64> = pairs
        .map(|(strand, (gpu, reference))| {
            let length = lengths[strand % lengths.len()];
            let errors = gpu.iter().zip(reference).map(|(gpu, reference)| {
                let rounding = f64::from(f32::EPSILON) / 2.0 * reference.abs().max_element();
                let distance = gpu.truncate().as_dvec3().distance(*reference);
                match distance.is_finite() {
                    true if length < RESOLVED * rounding * vertices as f64 => 0.0,
                    true => (distance - ROUNDINGS * rounding).max(0.0) / length,
                    false => f64::INFINITY,
                }
            });
            errors.fold(0.0, f64::max)
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    errors
}

/// The largest of [`strand_errors`].
pub fn worst(strands: &Strands, gpu: &[Vec4], reference: &[DVec3]) -> f64 {
    strand_errors(strands, gpu, reference).last().copied().unwrap_or(0.0)
}

/// Lengths of the guides.
pub fn lengths(strands: &Strands) -> Vec<f64> {
    let lengths = strands.rest_lengths.chunks(strands.vertices as usize);
    lengths.map(|lengths| lengths.iter().map(|&length| f64::from(length)).sum()).collect()
}

/// In f64.
pub fn wide(positions: &[Vec4]) -> Vec<DVec3> {
    positions.iter().map(|position| position.truncate().as_dvec3()).collect()
}
