//! Hair against signed distance fields: the kernel against its reference, nothing gets through, friction, and what it costs where there is none.

#[path = "support/mesh.rs"]
mod mesh;
mod support;

use glam::{Quat, Vec3, Vec4};
use mesh::{Triangles, ball, torus};
use support::{gpu, taken_for};
use tressfx_asset::mesh::Mesh;
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::sim::{Motion, Random, random_strands, strand_errors, strands_of};
use tressfx_conformance::solid::Solid;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::Run;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::field::{FieldDesc, Fields};
use tressfx_sim::reference::{self, field::Field};
use tressfx_sim::{Collider, HairSim, SectionDesc, SimError, SimParams, Solver, StepInput};

const DT: f64 = 1.0 / 60.0;

/// A simulation with fields.
struct Bodies {
    backend: Box<dyn Run>,
    sim: HairSim,
    fields: Fields,
    strands: Strands,
}

impl Bodies {
    /// On wgpu.
    fn new(strands: Strands, params: SimParams, solver: Solver, descs: &[FieldDesc]) -> Option<Self> {
        Some(Self::on(gpu()?, strands, params, solver, descs))
    }

    fn on(mut backend: Box<dyn Run>, strands: Strands, params: SimParams, solver: Solver, descs: &[FieldDesc]) -> Self {
        let mut list = PassList::new();
        let mut fields = Fields::new(&mut *backend, &mut list, descs).expect("the meshes are bodies");
        fields.record(&mut list);
        let desc = SectionDesc::new(&strands, params).with_solver(solver);
        let sim = HairSim::with_fields(&mut *backend, &mut list, &[desc], 4, &fields).expect("the simulation is made");
        backend.run(&list).expect("the list runs");
        Self { backend, sim, fields, strands }
    }

    fn frame(&mut self, input: &StepInput) {
        let mut list = PassList::new();
        self.sim.step(&mut list, input).expect("the input is fine");
        self.backend.run(&list).expect("the list runs");
    }

    fn on_head(&self, index: usize) -> Collider<'static> {
        Collider::with_head(self.fields.shape(index).expect("there is one"))
    }

    fn words<T: bytemuck::Pod>(&mut self, ticket: Ticket) -> Vec<T> {
        bytemuck::pod_collect_to_vec(&self.backend.read(ticket).ready().expect("the list has run"))
    }

    /// Positions of the guides about the centre, strand-major.
    fn positions(&mut self) -> Vec<Vec4> {
        let mut list = PassList::new();
        let ticket = self.sim.read_positions(&mut list)[0];
        self.backend.run(&list).expect("the list runs");
        let positions = self.words::<Vec4>(ticket);
        self.strands.deinterleave(&positions)[..self.strands.rest.len()].to_vec()
    }

    /// Positions of the guides as the head sees them, in the space of the rest pose.
    fn in_rest_space(&mut self, head: &Pose) -> Vec<Vec4> {
        let (pose, back) = (self.sim.pose(), head.rotation.inverse());
        let place = |point: &Vec4| (back * (pose.transform(point.truncate()) - head.translation)).extend(point.w);
        self.positions().iter().map(place).collect()
    }

    fn field(&mut self, index: usize) -> Field {
        let mut list = PassList::new();
        let tickets = self.fields.read(&mut list, index).expect("there is one");
        self.backend.run(&list).expect("the list runs");
        let [header, distances] = tickets.map(|ticket| self.words::<u32>(ticket));
        Field::from_words(&header, &distances).expect("the field is whole")
    }
}

fn limp() -> SimParams {
    SimParams { global_stiffness: 0.0, local_stiffness: 0.0, ..SimParams::default() }
}

fn at(translation: Vec3) -> Pose {
    Pose { translation, ..Pose::IDENTITY }
}

fn scaled((positions, indices): Triangles, size: f32) -> Triangles {
    (positions.into_iter().map(|point| point * size).collect(), indices)
}

/// A ring that turns and falls through random strands.
fn ring_at(frame: u32) -> Pose {
    let translation = Vec3::new(0.1, 0.1 - 0.01 * frame as f32, 0.0);
    Pose { rotation: Quat::from_rotation_x(0.05 * frame as f32), translation }
}

/// Frames of a groom on a head that is shaken, with a ball on it and a ring that moves by itself.
fn shaken(bodies: &mut Bodies, frames: u32, mut also: impl FnMut(&StepInput)) {
    let motion = Motion { wind: None, ..Motion::wild(&bodies.strands) };
    for frame in 0..=frames {
        let ring = bodies.fields.shape(0).unwrap();
        let colliders = [bodies.on_head(1), Collider::free(ring, ring_at(frame), ring_at(frame + 1))];
        let dt = if frame == 0 { 0.0 } else { DT };
        let input = motion.input(f64::from(frame) * DT, dt).with_colliders(&colliders);
        bodies.frame(&input);
        also(&input);
    }
}

/// What strands of a test meet: a ring and a ball.
fn ring_and_ball() -> [Triangles; 2] {
    [scaled(torus(60, 0.7, 20, 0.23), 0.25), scaled(ball(32), 0.1)]
}

fn descs_of([ring, ball]: &[Triangles; 2]) -> [FieldDesc<'_>; 2] {
    [
        FieldDesc::new(&ring.0, &ring.1).with_nodes(48).with_margin(0.002),
        FieldDesc::new(&ball.0, &ball.1).with_nodes(32),
    ]
}

#[test]
fn contacts_match_their_reference() {
    let meshes = ring_and_ball();
    let strands = random_strands(60, 16, 1, 5);
    // Where a step of a way is decided by rounding, a strand goes another way: of the rods, whose contacts are springs, few do.
    // On a GPU threads go along a rod together.
    for (solver, is_cpu) in [(Solver::TressFx, true), (Solver::Direct, true), (Solver::Direct, false)] {
        let params = SimParams { global_stiffness: 0.1, ..SimParams::default() };
        let desc = SectionDesc::new(&strands, params.clone()).with_solver(solver);
        let Some(gpu) = gpu() else { return };
        let backend = taken_for(*gpu, is_cpu);
        let mut bodies = Bodies::on(backend, strands.clone(), params, solver, &descs_of(&meshes));
        let fields = vec![bodies.field(0), bodies.field(1)];
        let mut reference = reference::Simulation::new(std::slice::from_ref(&desc)).unwrap().with_fields(fields);
        let mut free = reference::Simulation::new(&[desc]).unwrap();
        shaken(&mut bodies, 6, |input| {
            reference.step(input).unwrap();
            free.step(&StepInput { colliders: &[], ..*input }).unwrap();
        });
        let (expected, free) = (reference.positions(0), free.positions(0));
        let expected = &expected[..strands.rest.len()];
        let errors = strand_errors(&strands, &bodies.positions(), expected);
        let [median, held, largest] = [30, 57, 59].map(|index| errors[index]);
        let touched = expected.chunks(16).zip(free.chunks(16)).filter(|(one, other)| one != other).count();
        println!(
            "{solver:?}: {touched} of 60 strands touch; {median:.1e} (median) {held:.1e} (95 %) {largest:.1e} (largest) of strand length"
        );
        assert!(touched > 30, "{touched}");
        assert!(held < 2e-3 && median < 1e-4, "{solver:?}: {held:e} {median:e}");
    }
}

#[test]
fn both_backends_collide_the_same_to_the_bit() {
    let meshes = ring_and_ball();
    for solver in [Solver::TressFx, Solver::Direct] {
        let on = |backend| {
            let mut bodies =
                Bodies::on(backend, random_strands(70, 12, 1, 6), SimParams::default(), solver, &descs_of(&meshes));
            shaken(&mut bodies, 5, |_| {});
            bodies.positions()
        };
        let Some(wgpu) = gpu() else { return };
        let first = on(wgpu);
        let options = VulkanOptions { validation: true, ..Default::default() };
        assert!(first == on(Box::new(VulkanBackend::headless_with(&options).unwrap())), "{solver:?}");
    }
}

/// Straight strands of two vertices, as long as given.
fn bristles(roots: &[Vec3], way: impl Fn(usize) -> Vec3) -> Strands {
    let points =
        roots.iter().enumerate().flat_map(|(index, root)| [root.to_array(), (*root + way(index)).to_array()]).collect();
    strands_of(HairAsset::new("bristles", AssetFormat::Builtin, points, vec![2; roots.len()]), 0)
}

/// Of a box whose corners are numbered by their bits.
fn box_faces() -> Vec<u32> {
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect()
}

/// A body that flies at 10 m/s through 2,000 tips, from many sides and in many frames: no tip is ever behind it or in it. The tips are free, the roots far
/// away, so that nothing but the contact holds them.
#[test]
fn nothing_gets_through_at_10_metres_a_second() {
    // A plate of 2 cm, as thick as a hand: a cell is 6 mm, and in a sub-step it moves by 83 mm.
    let plate: Vec<Vec3> =
        (0..8).map(|i| Vec3::new([-0.15, 0.15][i & 1], [-0.15, 0.15][i >> 1 & 1], [-0.01, 0.01][i >> 2])).collect();
    let indices = box_faces();
    let (mut cases, mut through, mut deepest, mut met) = (0, 0, 0.0f64, 0);
    let mut random = Random::new(3);
    for side in 0..6 {
        let rotation =
            Quat::from_euler(glam::EulerRot::XYZ, 3.0 * random.signed(), 3.0 * random.signed(), 3.0 * random.signed());
        let along = rotation * Vec3::Z;
        let (u, v) = (rotation * Vec3::X, rotation * Vec3::Y);
        // Tips in the way of the middle of the plate. Roots hang back on long edges whose length nothing keeps.
        let roots: Vec<Vec3> = (0..2000)
            .map(|_| 0.1 * random.signed() * u + 0.1 * random.signed() * v + (0.2 * random.signed() + 1.5) * along)
            .collect();
        let params = SimParams { gravity: Vec3::ZERO, length_iterations: 0, friction: 0.4, damping: 0.0, ..limp() };
        let desc = FieldDesc::new(&plate, &indices).with_nodes(64);
        let strands = bristles(&roots, |_| -1.5 * along);
        let Some(mut bodies) = Bodies::new(strands, params, Solver::TressFx, &[desc]) else { return };
        let solid = Solid::new(&plate, &indices);
        let speed = 10.0;
        let place = |frame: i32| Pose {
            rotation,
            translation: along * (0.5 * side as f32 / 6.0 * 0.1667 - 0.6 + speed * DT as f32 * frame as f32),
        };
        bodies.frame(&StepInput::new(0.0, Pose::IDENTITY));
        for frame in 0..10 {
            let shape = bodies.fields.shape(0).unwrap();
            let body = Collider::free(shape, place(frame), place(frame + 1));
            bodies.frame(&StepInput::new(DT, Pose::IDENTITY).with_colliders(&[body]));
            let pose = place(frame + 1);
            for strand in bodies.in_rest_space(&Pose::IDENTITY).chunks(2) {
                let tip = (rotation.inverse() * (strand[1].truncate() - pose.translation)).as_dvec3();
                // All are before it, for it was behind all of them.
                cases += 1;
                let depth = -solid.distance(tip);
                through += usize::from(tip.z < -0.005 || depth > 0.005);
                deepest = deepest.max(depth);
                met += usize::from(depth > -0.003);
            }
        }
    }
    println!("{cases} swept cases, {met} at the surface, {through} through, deepest {deepest:.4} m");
    assert!(met > cases / 10, "{met} of {cases}");
    assert_eq!(through, 0);
}

/// How far strands that lie on a bar go along it while it moves along its axis.
fn dragged(solver: Solver, friction: f32, speed: f32) -> Option<f32> {
    let axis = Capsule { a: Vec3::X * -0.4, b: Vec3::X * 0.4, radius_a: 0.06, radius_b: 0.06 };
    let bar = Mesh::capsule(&axis, 32);
    let points = (0..20)
        .flat_map(|strand| (0..12).map(move |vertex| [0.01 * (strand as f32 - 9.5), -0.02 * vertex as f32, 0.0]));
    let curtain = strands_of(HairAsset::new("curtain", AssetFormat::Builtin, points.collect(), vec![12; 20]), 0);
    let desc = FieldDesc::new(&bar.positions, &bar.indices);
    let mut bodies = Bodies::new(curtain, SimParams { friction, ..limp() }, solver, &[desc])?;
    let place = |frame: u32| at(Vec3::new(speed * DT as f32 * frame as f32, -0.12, -0.03));
    bodies.frame(&StepInput::new(0.0, Pose::IDENTITY));
    for frame in 0..30 {
        let body = Collider::free(bodies.fields.shape(0).unwrap(), place(frame), place(frame + 1));
        bodies.frame(&StepInput::new(DT, Pose::IDENTITY).with_colliders(&[body]));
    }
    let now = bodies.in_rest_space(&Pose::IDENTITY);
    let rest = bodies.strands.rest.clone();
    Some(now.chunks(12).zip(rest.chunks(12)).map(|(now, rest)| now[6].x - rest[6].x).sum::<f32>() / 20.0)
}

#[test]
fn friction_is_against_the_motion_of_the_body() {
    for solver in [Solver::TressFx, Solver::Direct] {
        let Some(forth) = dragged(solver, 0.4, 0.5) else { return };
        let ice = dragged(solver, 0.0, 0.5).unwrap();
        println!("{solver:?}: {forth} m forth, {ice} m on ice");
        assert!(forth > 5e-3 && ice.abs() < 1e-4, "{solver:?}: {forth} {ice}");
    }
}

/// A floor that comes up to hanging strands at 10 m/s, from many sides, and stops before their roots: in a sub-step it goes further than it is
/// thick. No vertex is ever behind it, and none stays in it.
#[test]
fn nothing_of_a_rod_gets_through_at_10_metres_a_second() {
    let floor: Vec<Vec3> =
        (0..8).map(|i| Vec3::new([-0.6, 0.6][i & 1], [-0.025, 0.025][i >> 1 & 1], [-0.6, 0.6][i >> 2])).collect();
    let indices = box_faces();
    let mut random = Random::new(4);
    let (mut cases, mut met, mut behind, mut deepest) = (0, 0, 0, [0.0f64; FRAMES]);
    let (mut within, mut past_the_middle) = (0, 0);
    const FRAMES: usize = 20;
    let solid = Solid::new(&floor, &indices);
    for _ in 0..2 {
        let roots: Vec<Vec3> = (0..250).map(|_| Vec3::new(0.2 * random.signed(), 0.0, 0.2 * random.signed())).collect();
        let points = roots
            .iter()
            .flat_map(|root| (0..16).map(move |vertex| (*root - Vec3::Y * 0.0133 * vertex as f32).to_array()));
        let strands = strands_of(HairAsset::new("hanging", AssetFormat::Builtin, points.collect(), vec![16; 250]), 0);
        let desc = FieldDesc::new(&floor, &indices);
        let Some(mut bodies) = Bodies::new(strands, SimParams::default(), Solver::Direct, &[desc]) else { return };
        let tilt = Quat::from_euler(glam::EulerRot::XYZ, 0.15 * random.signed(), 0.0, 0.15 * random.signed());
        let along = Vec3::new(0.5 * random.signed(), 1.0, 0.5 * random.signed()).normalize();
        let place = |frame: u32| {
            let left = 10.0 * DT as f32 * (3 - frame.min(3)) as f32;
            Pose { rotation: tilt, translation: Vec3::Y * -0.15 - along * left }
        };
        bodies.frame(&StepInput::new(0.0, Pose::IDENTITY));
        for (frame, deepest) in deepest.iter_mut().enumerate() {
            let frame = frame as u32;
            let body = Collider::free(bodies.fields.shape(0).unwrap(), place(frame), place(frame + 1));
            bodies.frame(&StepInput::new(DT, Pose::IDENTITY).with_colliders(&[body]));
            let pose = place(frame + 1);
            for vertex in bodies.in_rest_space(&Pose::IDENTITY).iter().filter(|vertex| vertex.w > 0.0) {
                let point = (tilt.inverse() * (vertex.truncate() - pose.translation)).as_dvec3();
                let depth = -solid.distance(point);
                cases += 1;
                met += usize::from(depth > -0.003);
                behind += usize::from(point.y < -0.025);
                within += usize::from(depth > 0.0);
                past_the_middle += usize::from(point.y < 0.0);
                *deepest = deepest.max(depth);
            }
        }
    }
    println!(
        "{cases} swept cases, {met} at the surface, {within} of them within, {past_the_middle} past the middle, {behind} behind, deepest {deepest:.4?} m"
    );
    assert!(met > 1000, "{met} of {cases}");
    // What lies on the floor is held by springs: it is at the side that it came from, and less deep than a cell is wide, 21 mm.
    assert_eq!((past_the_middle, behind), (0, 0));
    assert!(deepest.iter().all(|depth| *depth < 0.005), "{deepest:?}");
}

/// Hair that begins deep inside of a ball finds its way out, and stays as far away as the margin says.
#[test]
fn deep_hair_finds_its_way_out() {
    let ball = scaled(ball(48), 0.2);
    let center = Vec3::new(0.3, -0.2, 0.1) * 0.2;
    let mut random = Random::new(8);
    let roots: Vec<Vec3> = (0..500).map(|_| center + 0.6 * random.vector().normalize()).collect();
    let tips: Vec<Vec3> = (0..500).map(|_| center + 0.17 * random.vector()).collect();
    let strands = bristles(&roots, |index| tips[index] - roots[index]);
    let params = SimParams { gravity: Vec3::ZERO, length_iterations: 0, ..limp() };
    let margin = 0.004;
    let desc = FieldDesc::new(&ball.0, &ball.1).with_margin(margin);
    let Some(mut bodies) = Bodies::new(strands, params, Solver::TressFx, &[desc]) else { return };
    bodies.frame(&StepInput::new(0.0, Pose::IDENTITY));
    let mut deepest = Vec::new();
    for _ in 0..12 {
        let body = bodies.on_head(0);
        bodies.frame(&StepInput::new(DT, Pose::IDENTITY).with_colliders(&[body]));
        let solid = Solid::new(&ball.0, &ball.1);
        let clear = bodies
            .in_rest_space(&Pose::IDENTITY)
            .chunks(2)
            .map(|strand| solid.distance(strand[1].truncate().as_dvec3()))
            .fold(f64::INFINITY, f64::min);
        deepest.push(clear);
    }
    println!("least distance after each frame: {deepest:.4?} m");
    assert!(*deepest.last().unwrap() > 0.9 * f64::from(margin), "{deepest:?}");
}

/// What a scene does not use costs nothing.
#[test]
fn a_simulation_without_fields_has_nothing_of_them() {
    let mut backend = NullBackend::default();
    let (positions, indices) = ball(16);
    let mut list = PassList::new();
    let fields = Fields::new(&mut backend, &mut list, &[FieldDesc::new(&positions, &indices)]).unwrap();
    let strands = random_strands(8, 8, 0, 1);
    for (solver, label) in [(Solver::TressFx, "hair.sim.tressfx"), (Solver::Direct, "hair.sim.direct")] {
        let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(solver).with_own_roots();
        let mut slots = |fields: Option<&Fields>, most: usize| {
            let made = backend.shaders.len();
            match fields {
                Some(fields) => {
                    HairSim::with_fields(&mut backend, &mut PassList::new(), std::slice::from_ref(&desc), most, fields)
                }
                None => HairSim::new(&mut backend, &mut PassList::new(), std::slice::from_ref(&desc), most),
            }
            .unwrap();
            let shader = backend.shaders[made..].iter().find(|shader| shader.label == label).unwrap().clone();
            (shader.slots.len(), shader.wgsl.contains("field"), shader.wgsl.len())
        };
        let (capsules, none) = (slots(None, 1), slots(None, 0));
        assert_eq!((capsules.1, none.1), (false, false));
        assert_eq!(slots(Some(&fields), 0), none, "no room for colliders");
        let with = slots(Some(&fields), 1);
        assert_eq!((with.0, with.1), (capsules.0 + 1, true));

        let mut sim = HairSim::with_fields(&mut backend, &mut list, std::slice::from_ref(&desc), 2, &fields).unwrap();
        sim.step(&mut list, &StepInput::new(DT, Pose::IDENTITY)).unwrap();
        let body = Collider::with_head(fields.shape(0).unwrap());
        let mut list = PassList::new();
        sim.step(&mut list, &StepInput::new(DT, Pose::IDENTITY).with_colliders(&[body])).unwrap();
        assert!(list.labels().all(|label| !label.contains("field")), "a body at rest is not made anew");

        let mut without = HairSim::new(&mut backend, &mut list, std::slice::from_ref(&desc), 2).unwrap();
        let error = without.step(&mut list, &StepInput::new(DT, Pose::IDENTITY).with_colliders(&[body])).unwrap_err();
        assert_eq!(error, SimError::NoField { index: 0, field: 0, count: 0 });
    }
}
