//! Hair against signed distance fields: the kernel against its reference, nothing gets through, friction, and what it costs where there is none.

#[path = "support/mesh.rs"]
mod mesh;
mod support;

use glam::{Quat, Vec3, Vec4};
use mesh::{Triangles, ball, bust, torus};
use support::gpu;
use tressfx_conformance::sim::{Motion, Random, random_strands, real, strand_errors, strands_of};
use tressfx_conformance::solid::Solid;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::Run;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{PassList, Ticket};
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
    fn new(strands: Strands, params: SimParams, descs: &[FieldDesc]) -> Option<Self> {
        let mut backend: Box<dyn Run> = gpu()?;
        let mut list = PassList::new();
        let mut fields = Fields::new(&mut *backend, &mut list, descs).expect("the meshes are bodies");
        fields.record(&mut list);
        let desc = SectionDesc::new(&strands, params).with_solver(Solver::TressFx);
        let sim = HairSim::with_fields(&mut *backend, &mut list, &[desc], 4, &fields).expect("the simulation is made");
        backend.run(&list).expect("the list runs");
        Some(Self { backend, sim, fields, strands })
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

/// A ring that turns among the tips of random strands, and a ball on the head.
#[test]
fn contacts_match_their_reference() {
    let (ring, ball) = (scaled(torus(60, 0.7, 20, 0.23), 0.25), scaled(ball(32), 0.1));
    let descs = [
        FieldDesc::new(&ring.0, &ring.1).with_nodes(48).with_margin(0.002),
        FieldDesc::new(&ball.0, &ball.1).with_nodes(32),
    ];
    let params = SimParams { global_stiffness: 0.1, ..SimParams::default() };
    let strands = random_strands(400, 16, 1, 5);
    let Some(mut bodies) = Bodies::new(strands.clone(), params.clone(), &descs) else { return };
    let fields = vec![bodies.field(0), bodies.field(1)];
    let desc = SectionDesc::new(&strands, params).with_solver(Solver::TressFx);
    let mut reference = reference::Simulation::new(&[desc]).unwrap().with_fields(fields);
    let motion = Motion { wind: None, ..Motion::wild(&strands) };
    let ring = |frame: u32| Pose {
        rotation: Quat::from_rotation_x(0.05 * frame as f32),
        translation: Vec3::new(0.1, 0.1 - 0.01 * frame as f32, 0.0),
    };
    let without = {
        let mut free = reference::Simulation::new(&[SectionDesc::new(
            &strands,
            SimParams { global_stiffness: 0.1, ..SimParams::default() },
        )
        .with_solver(Solver::TressFx)])
        .unwrap();
        for frame in 0..=10 {
            free.step(&motion.input(f64::from(frame) * DT, if frame == 0 { 0.0 } else { DT })).unwrap();
        }
        free.positions(0)
    };
    for frame in 0..=10 {
        let shape = bodies.fields.shape(0).unwrap();
        let colliders = [bodies.on_head(1), Collider::free(shape, ring(frame), ring(frame + 1))];
        let input = motion.input(f64::from(frame) * DT, if frame == 0 { 0.0 } else { DT }).with_colliders(&colliders);
        bodies.frame(&input);
        reference.step(&input).unwrap();
    }
    let expected = &reference.positions(0)[..strands.rest.len()];
    let errors = strand_errors(&strands, &bodies.positions(), expected);
    let held = errors[errors.len() * 95 / 100];
    let touched = expected.chunks(16).zip(without.chunks(16)).filter(|(one, other)| one != other).count();
    println!(
        "{touched} of 400 strands touch; {:.1e} (median) {held:.1e} (95 %) {:.1e} (largest) of strand length",
        errors[200], errors[399]
    );
    assert!(touched > 200, "{touched}");
    // Twenty sub-steps in which rounding decides on a step of a way now and then.
    assert!(held < 2e-3 && errors[200] < 1e-5, "{held:e} {:e}", errors[200]);
}

/// Straight strands of two vertices, as long as given.
fn bristles(roots: &[Vec3], way: impl Fn(usize) -> Vec3) -> Strands {
    let points =
        roots.iter().enumerate().flat_map(|(index, root)| [root.to_array(), (*root + way(index)).to_array()]).collect();
    strands_of(HairAsset::new("bristles", AssetFormat::Builtin, points, vec![2; roots.len()]), 0)
}

/// A body that flies at 10 m/s through 2,000 tips, from many sides and in many frames: no tip is ever behind it or in it. The tips are free, the roots far
/// away, so that nothing but the contact holds them.
#[test]
fn nothing_gets_through_at_10_metres_a_second() {
    // A plate of 2 cm, as thick as a hand: a cell is 6 mm, and in a sub-step it moves by 83 mm.
    let plate: Vec<Vec3> =
        (0..8).map(|i| Vec3::new([-0.15, 0.15][i & 1], [-0.15, 0.15][i >> 1 & 1], [-0.01, 0.01][i >> 2])).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let indices: Vec<u32> = faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
    let (mut cases, mut through, mut deepest, mut met) = (0, 0, 0.0f64, 0);
    let mut random = Random::new(3);
    for side in 0..12 {
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
        let Some(mut bodies) = Bodies::new(strands, params, &[desc]) else { return };
        let solid = Solid::new(&plate, &indices);
        let speed = 10.0;
        let place = |frame: i32| Pose {
            rotation,
            translation: along * (0.5 * side as f32 / 12.0 * 0.1667 - 0.6 + speed * DT as f32 * frame as f32),
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
fn dragged(friction: f32, speed: f32) -> Option<f32> {
    let bar = torus(80, 1.0, 24, 0.06);
    // A ring so large that it is nearly straight where the curtain lies on it.
    let bar: Triangles = (bar.0.iter().map(|point| Vec3::new(point.z, point.y, point.x - 1.0)).collect(), bar.1);
    let bar: Triangles = (bar.0, bar.1.chunks(3).flat_map(|t| [t[0], t[2], t[1]]).collect());
    let points = (0..20)
        .flat_map(|strand| (0..12).map(move |vertex| [0.01 * (strand as f32 - 9.5), -0.02 * vertex as f32, 0.0]));
    let curtain = strands_of(HairAsset::new("curtain", AssetFormat::Builtin, points.collect(), vec![12; 20]), 0);
    let desc = FieldDesc::new(&bar.0, &bar.1).with_nodes(96);
    let mut bodies = Bodies::new(curtain, SimParams { friction, ..limp() }, &[desc])?;
    let place = |frame: u32| {
        // About the axis of the ring, which is 1 m behind.
        let rotation = Quat::from_rotation_y(speed * DT as f32 * frame as f32);
        let center = Vec3::new(0.0, -0.12, -1.03);
        Pose { rotation, translation: center - rotation * Vec3::new(0.0, 0.0, -1.0) }
    };
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
    let Some(forth) = dragged(0.4, 0.5) else { return };
    let [back, ice, still] =
        [(0.4, -0.5), (0.0, 0.5), (0.4, 0.0)].map(|(friction, speed)| dragged(friction, speed).unwrap());
    println!("{forth} m forth, {back} m back, {ice} m on ice, {still} m on a bar at rest");
    assert!(forth > 5e-3 && back < -5e-3, "{forth} {back}");
    assert!(ice.abs() < 2e-3 && still.abs() < 1e-3, "{ice} {still}");
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
    let Some(mut bodies) = Bodies::new(strands, params, &[desc]) else { return };
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

/// Sintel's hair and her bust, as the head is shaken: no vertex is deeper than 1 % of the length of its strand.
#[test]
fn sintels_hair_stays_outside_of_her_bust() {
    let (Some(strands), Some((positions, indices))) =
        (real("sintel_lite/GEO-sintel_hair_emit.002-sintel_hair.tfx"), bust())
    else {
        return;
    };
    let desc = FieldDesc::new(&positions, &indices).with_nodes(96).with_margin(0.2);
    let motion = Motion { wind: None, ..Motion::wild(&strands) };
    let Some(mut bodies) = Bodies::new(strands, SimParams::default(), &[desc]) else { return };
    for frame in 0..=60 {
        let body = bodies.on_head(0);
        let input = motion.input(f64::from(frame) * DT, if frame == 0 { 0.0 } else { DT });
        bodies.frame(&input.with_colliders(&[body]));
    }
    let solid = Solid::new(&positions, &indices);
    let now = bodies.in_rest_space(&motion.head(1.0));
    let (mut deepest, mut near) = (0.0f64, 0);
    let vertices = bodies.strands.vertices as usize;
    for (strand, lengths) in now.chunks(vertices).zip(bodies.strands.rest_lengths.chunks(vertices)) {
        let length = f64::from(lengths.iter().sum::<f32>());
        for vertex in strand.iter().filter(|vertex| vertex.w > 0.0) {
            let distance = solid.distance(vertex.truncate().as_dvec3()) / length;
            deepest = deepest.max(-distance);
            near += usize::from(distance < 0.03);
        }
    }
    println!("{near} vertices near the skin, deepest {deepest:.4} of strand length");
    assert!(near > 100 && deepest < 0.01, "{near} near, {deepest} of strand length");
}

/// What a scene does not use costs nothing.
#[test]
fn a_simulation_without_fields_has_nothing_of_them() {
    let mut backend = NullBackend::default();
    let (positions, indices) = ball(16);
    let mut list = PassList::new();
    let fields = Fields::new(&mut backend, &mut list, &[FieldDesc::new(&positions, &indices)]).unwrap();
    let strands = random_strands(8, 8, 0, 1);
    let desc = SectionDesc::new(&strands, SimParams::default()).with_solver(Solver::TressFx);
    let mut slots = |fields: Option<&Fields>, most: usize| {
        let made = backend.shaders.len();
        match fields {
            Some(fields) => HairSim::with_fields(&mut backend, &mut PassList::new(), &[desc.clone()], most, fields),
            None => HairSim::new(&mut backend, &mut PassList::new(), &[desc.clone()], most),
        }
        .unwrap();
        let shader = backend.shaders[made..].iter().find(|shader| shader.label == "hair.sim.tressfx").unwrap().clone();
        (shader.slots.len(), shader.wgsl.contains("field"), shader.wgsl.len())
    };
    let (capsules, none) = (slots(None, 1), slots(None, 0));
    assert_eq!((capsules.1, none.1), (false, false));
    assert_eq!(slots(Some(&fields), 0), none, "no room for colliders");
    let with = slots(Some(&fields), 1);
    assert_eq!((with.0, with.1), (capsules.0 + 1, true));

    let mut sim = HairSim::with_fields(&mut backend, &mut list, &[desc.clone()], 2, &fields).unwrap();
    sim.step(&mut list, &StepInput::new(DT, Pose::IDENTITY)).unwrap();
    let body = Collider::with_head(fields.shape(0).unwrap());
    let mut list = PassList::new();
    sim.step(&mut list, &StepInput::new(DT, Pose::IDENTITY).with_colliders(&[body])).unwrap();
    assert!(list.labels().all(|label| !label.contains("field")), "a body at rest is not made anew");

    let mut without = HairSim::new(&mut backend, &mut list, &[desc.clone()], 2).unwrap();
    let error = without.step(&mut list, &StepInput::new(DT, Pose::IDENTITY).with_colliders(&[body])).unwrap_err();
    assert_eq!(error, SimError::NoField { index: 0, field: 0, count: 0 });
    let error = HairSim::with_fields(
        &mut backend,
        &mut list,
        &[desc.clone(), SectionDesc::new(&strands, SimParams::default())],
        1,
        &fields,
    )
    .unwrap_err();
    assert_eq!(error, SimError::FieldSolver { section: 1 });
}
