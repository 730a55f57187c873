//! Bodies that move under the hair: skinning, and roots on triangles and on bones, against f64; both backends; what costs nothing.

mod support;

use std::f32::consts::PI;

use glam::{Affine3A, DQuat, DVec3, Quat, Vec3};
use support::gpu;
use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::sim::{Random, random_asset, strands_of};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::{Backend, BufferDesc, Run};
use tressfx_core::body::{BodyError, Influences, MeshPose, Morph, MorphOffset, SkinnedMesh};
use tressfx_core::id::BufferId;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::body::{BindError, Binding, BoneRoots, JointPalette, MeshVertices, Skinning, TriangleRoots};
use tressfx_sim::reference::{self, RootPlace};
use tressfx_sim::{HairSim, RootTransform, SectionDesc, SimError, SimParams, Solver, StepInput};

/// Quads of the patch, each way. It is a body of 2 units, from -1 to 1, a good way from the origin.
const SIDE: u32 = 24;
const MIDDLE: Vec3 = Vec3::new(0.5, 1.5, -0.25);
const SIZE: f64 = 2.0;
/// What may be lost of the size of the body.
const ERROR: f64 = 1e-5;

fn on_patch(u: f32, v: f32) -> Vec3 {
    MIDDLE + Vec3::new(2.0 * u - 1.0, 0.3 * (3.0 * u).sin() * (2.0 * v).cos(), 2.0 * v - 1.0)
}

/// A curved patch between three joints, with two morph targets, one of which moves only a part of it.
fn patch() -> SkinnedMesh {
    let mut mesh = SkinnedMesh { name: "patch".into(), ..SkinnedMesh::default() };
    mesh.joints = ["left", "middle", "right"].map(str::to_owned).to_vec();
    mesh.morphs = ["swell", "corner"].map(|name| Morph { name: name.into(), offsets: Vec::new() }).to_vec();
    for row in 0..=SIDE {
        for column in 0..=SIDE {
            let (u, v) = (column as f32 / SIDE as f32, row as f32 / SIDE as f32);
            let vertex = mesh.positions.len() as u32;
            mesh.positions.push(on_patch(u, v));
            let along = [on_patch(u + 1e-3, v) - on_patch(u, v), on_patch(u, v + 1e-3) - on_patch(u, v)];
            mesh.normals.push(along[1].cross(along[0]).normalize());
            mesh.tangents.push(along[0].normalize().extend(if column % 2 == 0 { 1.0 } else { -1.0 }));
            let pairs =
                [(0, (1.0 - 2.0 * u).max(0.0)), (1, 1.0 - (2.0 * u - 1.0).abs()), (2, (2.0 * u - 1.0).max(0.0))];
            mesh.influences.push(Influences::strongest(&pairs).unwrap());
            let offset = |position, normal| MorphOffset { vertex, position, normal };
            mesh.morphs[0].offsets.push(offset(Vec3::Y * 0.3 * (1.0 - u) * v, Vec3::new(0.1, 0.0, -0.1 * u)));
            if u > 0.7 && v > 0.7 {
                mesh.morphs[1].offsets.push(offset(Vec3::new(0.2, 0.1, 0.3) * (u - 0.7), Vec3::ZERO));
            }
        }
    }
    for row in 0..SIDE {
        for column in 0..SIDE {
            let corner = row * (SIDE + 1) + column;
            let (right, up) = (corner + 1, corner + SIDE + 1);
            mesh.triangles.extend([[corner, up, right], [right, up, up + 1]]);
        }
    }
    mesh
}

/// Twisted, stretched and morphed by a share.
fn pose(share: f32) -> MeshPose {
    let about = |rotation: Quat, scale: Vec3, shift: Vec3| {
        Affine3A::from_translation(MIDDLE + shift)
            * Affine3A::from_scale_rotation_translation(scale, rotation, Vec3::ZERO)
            * Affine3A::from_translation(-MIDDLE)
    };
    let (twist, stretch) = (Quat::from_rotation_x(1.8 * share), Vec3::ONE + share * Vec3::new(0.8, 0.0, -0.3));
    MeshPose {
        joints: vec![
            about(twist, Vec3::ONE, Vec3::X * -0.2 * share),
            about(Quat::from_rotation_z(0.4 * share), stretch, Vec3::ZERO),
            about(twist.inverse() * Quat::from_rotation_y(0.7 * share), Vec3::ONE, Vec3::new(0.4, 0.1, 0.0) * share),
        ],
        morphs: vec![share, -0.5 * share],
    }
}

/// Short strands along the normals of the patch, some of them a little above or below it.
fn fur(guides: u32, vertices: u32) -> Strands {
    let mut random = Random::new(7);
    let mut points = Vec::new();
    for _ in 0..guides {
        let [u, v] = [random.signed(), random.signed()].map(|number| 0.5 + 0.49 * number);
        let root = on_patch(u, v) + Vec3::Y * 0.003 * random.signed();
        let way = (Vec3::Y + 0.5 * random.vector()).normalize();
        points.extend((0..vertices).map(|vertex| (root + way * 0.03 * vertex as f32).to_array()));
    }
    strands_of(HairAsset::new("fur", AssetFormat::Builtin, points, vec![vertices; guides as usize]), 0)
}

/// Each strand of the file with the joints of the nearest vertex.
fn influences(strands: &Strands, mesh: &SkinnedMesh) -> Vec<Influences> {
    let mut of_file = vec![Influences::rigid(0); strands.order.len()];
    for (guide, &strand) in strands.rest.chunks(strands.vertices as usize).zip(&strands.order) {
        let root = guide[0].truncate();
        let near = |vertex: &usize| mesh.positions[*vertex].distance(root);
        let nearest = (0..mesh.positions.len()).min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
        of_file[strand as usize] = mesh.influences[nearest];
    }
    of_file
}

fn roots(strands: &Strands) -> Vec<Vec3> {
    strands.rest.chunks(strands.vertices as usize).map(|guide| guide[0].truncate()).collect()
}

/// A groom on a body, on a GPU.
struct Rig {
    backend: Box<dyn Run>,
    sim: HairSim,
    skinning: Skinning,
    binding: Binding,
    triangles: TriangleRoots,
    bones: BoneRoots,
}

impl Rig {
    fn new(mut backend: Box<dyn Run>, strands: &Strands, mesh: &SkinnedMesh, solver: Solver) -> Self {
        let mut list = PassList::new();
        let desc = SectionDesc::new(strands, SimParams::default()).with_own_roots().with_solver(solver);
        let sim = HairSim::new(&mut *backend, &mut list, &[desc], 0).unwrap();
        let skinning = Skinning::new(&mut *backend, &mut list, mesh, true).unwrap();
        let binding = Binding::of_guides(strands, mesh, 0.01).unwrap();
        let vertices = skinning.mesh_vertices();
        let triangles = TriangleRoots::new(&mut *backend, &mut list, &sim, 0, &binding, vertices).unwrap();
        let of = influences(strands, mesh);
        let bones = BoneRoots::new(&mut *backend, &mut list, (&sim, 0), strands, &of, skinning.palette()).unwrap();
        backend.run(&list).unwrap();
        Self { backend, sim, skinning, binding, triangles, bones }
    }

    fn read<T: bytemuck::Pod>(&mut self, buffer: BufferId, count: usize) -> Vec<T> {
        let mut list = PassList::new();
        let ticket = list.read_buffer(buffer, 0, (size_of::<T>() * count) as u64);
        self.backend.run(&list).unwrap();
        bytemuck::pod_collect_to_vec(&self.backend.read(ticket).ready().unwrap())
    }

    fn vertices(&mut self, buffer: BufferId, count: usize) -> Vec<[[f32; 4]; 2]> {
        self.read(buffer, count)
    }

    fn targets(&mut self, guides: usize) -> Vec<RootTransform> {
        let buffer = self.sim.root_transforms(0).unwrap();
        self.read(buffer, guides)
    }

    /// Poses the body and writes the roots by its triangles or by bones.
    fn pose(&mut self, pose: &MeshPose, by_bones: bool) {
        let mut list = PassList::new();
        self.skinning.pose(&mut list, pose).unwrap();
        match by_bones {
            true => self.bones.record(&mut list, &mut self.sim),
            false => self.triangles.record(&mut list, &mut self.sim),
        }
        self.backend.run(&list).unwrap();
    }
}

/// The largest distance between where two transforms take the root of a guide and points about it.
fn apart(now: &RootTransform, expected: &RootPlace, root: DVec3) -> f64 {
    let now = RootPlace::from(*now);
    let take = |place: &RootPlace, point: DVec3| place.rotation * point + place.place;
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|axis| root + 0.1 * axis);
    points.map(|point| take(&now, point).distance(take(expected, point))).into_iter().fold(0.0, f64::max)
}

#[test]
fn a_twisted_stretched_and_morphed_patch_is_skinned_as_in_f64() {
    let Some(gpu) = gpu() else { return };
    let (mesh, strands) = (patch(), fur(100, 4));
    let mut rig = Rig::new(gpu, &strands, &mesh, Solver::TressFx);
    let count = mesh.positions.len();
    let mut last: Option<Vec<[[f32; 4]; 2]>> = None;
    for share in [0.0, 0.3, 1.0, -1.0] {
        rig.pose(&pose(share), false);
        let now = rig.vertices(rig.skinning.vertices(), count);
        let expected = reference::skin(&mesh, &pose(share));
        let mut errors = [0.0f64; 2];
        for (now, expected) in now.iter().zip(&expected) {
            for part in 0..2 {
                let now = Vec3::from_slice(&now[part]).as_dvec3();
                errors[part] = errors[part].max(now.distance(expected[part]));
            }
        }
        println!("{share}: {:.1e} of size, normals {:.1e}", errors[0] / SIZE, errors[1]);
        assert!(errors[0] < 1e-6 * SIZE && errors[1] < 1e-5, "{errors:?}");
        let tangents: Vec<[f32; 4]> = rig.read(rig.skinning.tangents().unwrap(), count);
        let expected = reference::skin_tangents(&mesh, &pose(share));
        for (((now, expected), bound), normal) in tangents.iter().zip(&expected).zip(&mesh.tangents).zip(&now) {
            let along = Vec3::from_slice(&now[..3]).as_dvec3();
            let across = along.dot(Vec3::from_slice(&normal[1][..3]).as_dvec3());
            assert!(along.distance(*expected) < 1e-5 && across.abs() < 1e-6 && now[3] == bound.w, "{share}: {now:?}");
        }
        // The frame before; of the first one itself.
        let past = rig.vertices(rig.skinning.past_vertices().unwrap(), count);
        assert!(past == *last.as_ref().unwrap_or(&now), "{share}");
        last = Some(now);
    }
}

#[test]
fn roots_follow_the_patch_as_in_f64_by_triangles_and_by_bones() {
    let Some(gpu) = gpu() else { return };
    let (mesh, strands) = (patch(), fur(1000, 4));
    let mut rig = Rig::new(gpu, &strands, &mesh, Solver::TressFx);
    let center = rig.sim.center().as_dvec3();
    let (of, roots) = (influences(&strands, &mesh), roots(&strands));
    for share in [0.0, 0.25, 1.0, -1.0] {
        let pose = pose(share);
        let positions: Vec<DVec3> = reference::skin(&mesh, &pose).iter().map(|vertex| vertex[0]).collect();
        let mut largest = [0.0f64; 2];
        for by_bones in [false, true] {
            rig.pose(&pose, by_bones);
            let targets = rig.targets(roots.len());
            for (guide, now) in targets.iter().enumerate() {
                let bound = &rig.binding.roots[guide];
                let root = roots[guide].as_dvec3();
                let expected = if by_bones {
                    let next = strands.rest[guide * 4 + 1].truncate().as_dvec3();
                    let (x, y) = (next - root).normalize().any_orthonormal_pair();
                    let frame = DQuat::from_mat3(&glam::DMat3::from_cols(x, y, (next - root).normalize()));
                    reference::bone_roots(root, frame, &of[strands.order[guide] as usize], &pose.joints, center)
                } else {
                    reference::triangle_roots(bound, &positions, center, &RootPlace::WITH_HEAD)
                };
                let error = apart(now, &expected, root - center);
                largest[usize::from(by_bones)] = largest[usize::from(by_bones)].max(error);
                assert!((now.rotation.length() - 1.0).abs() < 1e-5, "{guide}: {now:?}");
            }
        }
        let [triangles, bones] = largest.map(|error| error / SIZE);
        println!("{share}: {triangles:.1e} of size by triangles, {bones:.1e} by bones");
        assert!(triangles < ERROR && bones < ERROR, "{share}: {triangles:e} {bones:e}");
    }
}

#[test]
fn a_body_that_turns_as_a_whole_turns_its_roots_as_a_whole() {
    let Some(gpu) = gpu() else { return };
    let (mesh, strands) = (patch(), fur(200, 4));
    let mut rig = Rig::new(gpu, &strands, &mesh, Solver::TressFx);
    let (center, roots) = (rig.sim.center(), roots(&strands));
    // Half turns too, where a quaternion has no scalar part.
    for (axis, angle) in [(Vec3::X, PI), (Vec3::Y, 2.0), (Vec3::new(1.0, 1.0, 0.0).normalize(), PI)] {
        let turn = Pose { rotation: Quat::from_axis_angle(axis, angle), translation: Vec3::new(0.3, -0.2, 0.5) };
        let joint = Affine3A::from_rotation_translation(turn.rotation, turn.translation);
        let whole = MeshPose { joints: vec![joint; 3], morphs: vec![0.0; 2] };
        let expected = RootPlace::from(RootTransform::new(center, &turn));
        for by_bones in [false, true] {
            rig.pose(&whole, by_bones);
            for (now, root) in rig.targets(roots.len()).iter().zip(&roots) {
                let error = apart(now, &expected, (*root - center).as_dvec3());
                assert!(error < 3e-6 * SIZE, "{axis} {by_bones}: {error:e}");
            }
        }
    }
}

#[test]
fn both_backends_write_the_same_bits_and_the_strands_follow() {
    let (mesh, strands) = (patch(), fur(300, 6));
    let options = VulkanOptions { validation: true, ..VulkanOptions::default() };
    for solver in [Solver::TressFx, Solver::Direct] {
        let Some(gpu) = gpu() else { return };
        let vulkan = VulkanBackend::headless_with(&options).unwrap();
        // On GPUs two compilers may round in two ways.
        let is_exact = vulkan.caps().is_cpu;
        let mut one = Rig::new(gpu, &strands, &mesh, solver);
        let mut other = Rig::new(Box::new(vulkan), &strands, &mesh, solver);
        for frame in 0..12 {
            let pose = pose(frame as f32 / 11.0);
            for rig in [&mut one, &mut other] {
                rig.pose(&pose, frame % 3 == 2);
                let mut list = PassList::new();
                rig.sim.step(&mut list, &StepInput::new(1.0 / 60.0, Pose::IDENTITY)).unwrap();
                rig.backend.run(&list).unwrap();
            }
        }
        let count = mesh.positions.len();
        let vertices = [&mut one, &mut other].map(|rig| rig.vertices(rig.skinning.vertices(), count));
        let targets = [&mut one, &mut other].map(|rig| rig.targets(300));
        let hair = [&mut one, &mut other].map(|rig| {
            let buffers = rig.sim.buffers()[0];
            rig.read::<[f32; 4]>(buffers.positions, 1800)
        });
        assert!(
            !is_exact || (vertices[0] == vertices[1] && targets[0] == targets[1] && hair[0] == hair[1]),
            "{solver:?}"
        );
        // Roots are where the skin is.
        let center = one.sim.center().as_dvec3();
        for guide in 0..300 {
            let place = RootPlace::from(targets[0][guide]);
            let rest = strands.rest[6 * guide].truncate().as_dvec3() - center;
            let expected = place.rotation * rest + place.place;
            let now = Vec3::from_slice(&hair[0][guide]).as_dvec3();
            assert!(now.distance(expected) < ERROR * SIZE, "{solver:?} {guide}: {now} {expected}");
        }
    }
}

#[test]
fn an_engines_own_vertices_do_as_well_as_ours() {
    let Some(mut gpu) = gpu() else { return };
    let (mesh, strands) = (patch(), fur(200, 4));
    let posed = reference::skin(&mesh, &pose(0.6));
    let (stride, offset) = (44, 8);
    let mut bytes = vec![0xffu8; stride * posed.len() + offset];
    for (vertex, [position, _]) in posed.iter().enumerate() {
        let at = offset + stride * vertex;
        bytes[at..at + 12].copy_from_slice(bytemuck::cast_slice(&position.as_vec3().to_array()));
    }
    let buffer = gpu.create_buffer(&BufferDesc::storage("engine", bytes.len() as u64)).unwrap();
    let mut list = PassList::new();
    list.upload(buffer, 0, &bytes);
    let desc = SectionDesc::new(&strands, SimParams::default()).with_own_roots();
    let mut sim = HairSim::new(&mut *gpu, &mut list, &[desc], 0).unwrap();
    let binding = Binding::of_guides(&strands, &mesh, 0.01).unwrap();
    let vertices = MeshVertices { buffer, stride: 44, offset: 8, count: posed.len() as u32 };
    let roots = TriangleRoots::new(&mut *gpu, &mut list, &sim, 0, &binding, vertices).unwrap();
    roots.record(&mut list, &mut sim);
    let ticket = list.read_buffer(sim.root_transforms(0).unwrap(), 0, 32 * 200);
    gpu.run(&list).unwrap();
    let now: Vec<RootTransform> = bytemuck::pod_collect_to_vec(&gpu.read(ticket).ready().unwrap());
    let (center, positions) = (sim.center().as_dvec3(), posed.iter().map(|vertex| vertex[0]).collect::<Vec<_>>());
    for (now, bound) in now.iter().zip(&binding.roots) {
        let expected = reference::triangle_roots(bound, &positions, center, &RootPlace::WITH_HEAD);
        assert!(apart(now, &expected, bound.root - center) < ERROR * SIZE);
    }
    for wrong in [
        MeshVertices { count: 10, ..vertices },
        MeshVertices { stride: 43, ..vertices },
        MeshVertices { offset: 2, ..vertices },
        MeshVertices { stride: 8, ..vertices },
    ] {
        let error = TriangleRoots::new(&mut *gpu, &mut list, &sim, 0, &binding, wrong).unwrap_err();
        assert!(matches!(error, SimError::MeshVertices { .. }), "{error}");
    }
}

#[test]
fn a_collapsed_triangle_and_broken_vertices_leave_roots_finite() {
    let Some(gpu) = gpu() else { return };
    let (mesh, strands) = (patch(), fur(100, 4));
    let mut rig = Rig::new(gpu, &strands, &mesh, Solver::TressFx);
    rig.pose(&pose(0.5), false);
    let before = rig.targets(100);
    let flat = Affine3A::from_scale(Vec3::ZERO);
    rig.pose(&MeshPose { joints: vec![flat; 3], morphs: vec![0.0; 2] }, false);
    for (now, before) in rig.targets(100).iter().zip(&before) {
        assert_eq!(now.rotation, before.rotation, "it keeps what it had");
        assert!(now.place.is_finite());
    }
    rig.pose(&MeshPose { joints: vec![flat; 3], morphs: vec![0.0; 2] }, true);
    assert!(rig.targets(100).iter().all(|now| now.place.is_finite() && (now.rotation.length() - 1.0).abs() < 1e-5));
    // An engine's vertices that are no numbers move nothing.
    let last = rig.targets(100);
    let mut list = PassList::new();
    list.upload(rig.skinning.vertices(), 0, &vec![f32::NAN; 8 * mesh.positions.len()]);
    rig.triangles.record(&mut list, &mut rig.sim);
    rig.backend.run(&list).unwrap();
    assert!(rig.targets(100) == last);
}

#[test]
fn roots_are_bound_to_the_nearest_sound_triangle_and_what_is_wrong_is_named() {
    let mut mesh = patch();
    let strands = fur(500, 4);
    let report = Binding::of_guides(&strands, &mesh, 0.01).unwrap().report;
    println!("{report:?}");
    assert!(report.roots == 500 && report.largest < 0.004 && report.median < report.most && report.degenerate == 0);
    // Triangles without an area are passed over.
    let first = mesh.triangles[0][0];
    mesh.triangles.extend([[first, first, first + 1], [first; 3]]);
    assert_eq!(Binding::of_guides(&strands, &mesh, 0.01).unwrap().report.degenerate, 2);
    let error = Binding::of_guides(&strands, &mesh, 1e-4).unwrap_err();
    assert!(matches!(error, BindError::TooFar { .. }), "{error}");
    let at = |root: Vec3| Binding::of_roots(&[MIDDLE, root], &mesh, 10.0);
    assert_eq!(at(Vec3::NAN).unwrap_err(), BindError::NotFinite { strand: 1 });
    let error = at(Vec3::splat(100.0)).unwrap_err().to_string();
    assert!(error.contains("strand 1") && error.contains("patch"), "{error}");
    let flat = SkinnedMesh { triangles: vec![[0, 0, 1]], ..mesh.clone() };
    assert!(matches!(Binding::of_roots(&[MIDDLE], &flat, 1.0), Err(BindError::NoArea { triangles: 1, .. })));
    let none = SkinnedMesh { triangles: Vec::new(), ..mesh.clone() };
    let error = Binding::of_roots(&[MIDDLE], &none, 1.0).unwrap_err();
    assert!(matches!(error, BindError::Body(BodyError::Empty { what: "triangles", .. })), "{error}");
    let wrong = SkinnedMesh { triangles: vec![[0, 1, 99_999]], ..mesh };
    assert!(matches!(Binding::of_roots(&[MIDDLE], &wrong, 1.0), Err(BindError::Body(BodyError::Index { .. }))));
}

#[test]
fn poses_and_roots_that_do_not_fit_are_refused() {
    let (mesh, strands) = (patch(), fur(50, 4));
    let (mut backend, mut list) = (NullBackend::default(), PassList::new());
    let own = SectionDesc::new(&strands, SimParams::default()).with_own_roots();
    let sim =
        HairSim::new(&mut backend, &mut list, &[own, SectionDesc::new(&strands, SimParams::default())], 0).unwrap();
    let mut skinning = Skinning::new(&mut backend, &mut list, &mesh, false).unwrap();
    let count = |pose: MeshPose, skinning: &mut Skinning, list: &mut PassList| skinning.pose(list, &pose).unwrap_err();
    let rest = mesh.bind_pose();
    let error = count(MeshPose { joints: Vec::new(), ..rest.clone() }, &mut skinning, &mut list);
    assert!(matches!(error, SimError::Body(BodyError::Count { found: 0, expected: 3, .. })), "{error}");
    let error = count(MeshPose { morphs: vec![f32::NAN; 2], ..rest.clone() }, &mut skinning, &mut list);
    assert!(matches!(error, SimError::Body(BodyError::Value { .. })), "{error}");
    let (vertices, palette) = (skinning.mesh_vertices(), skinning.palette());
    let binding = Binding::of_guides(&strands, &mesh, 0.01).unwrap();
    let few = Binding { roots: binding.roots[..3].to_vec(), ..binding.clone() };
    let mut made = |section, binding: &Binding| {
        TriangleRoots::new(&mut backend, &mut list, &sim, section, binding, vertices).map(drop).unwrap_err()
    };
    assert_eq!(made(0, &few), SimError::RootCount { given: 3, expected: 50 });
    assert_eq!(made(1, &binding), SimError::RootCount { given: 50, expected: 0 });
    assert_eq!(made(2, &binding), SimError::NoSection { index: 2, count: 2 });
    let mut made = |of: &[Influences], palette| {
        BoneRoots::new(&mut backend, &mut list, (&sim, 0), &strands, of, palette).map(drop).unwrap_err()
    };
    assert_eq!(made(&[Influences::rigid(3); 50], palette), SimError::NoJoint { joint: 3, count: 3 });
    assert!(matches!(made(&[Influences::rigid(0); 3], palette), SimError::RootCount { given: 3, .. }));
    let error = JointPalette::new(&mut backend, &mut list, 70_000).unwrap_err();
    assert_eq!(error, SimError::TooManyJoints { given: 70_000, most: 65_536 });
}

#[test]
fn what_a_body_does_not_have_costs_nothing() {
    let bytes = |mesh: &SkinnedMesh, past| {
        let (mut backend, mut list) = (NullBackend::default(), PassList::new());
        let mut skinning = Skinning::new(&mut backend, &mut list, mesh, past).unwrap();
        let mut frame = PassList::new();
        skinning.pose(&mut frame, &mesh.bind_pose()).unwrap();
        skinning.pose(&mut frame, &mesh.bind_pose()).unwrap();
        let copies = frame.commands().iter().filter(|command| command.name() == "copy").count();
        assert_eq!(frame.labels().collect::<Vec<_>>(), ["hair.sim.skin"; 2]);
        let memory = backend.memory().bytes;
        skinning.destroy(&mut backend);
        assert_eq!(backend.memory().bytes, 0);
        (memory, copies)
    };
    let mesh = patch();
    let vertices = mesh.positions.len() as u64;
    let still = SkinnedMesh { morphs: Vec::new(), tangents: Vec::new(), ..mesh.clone() };
    assert_eq!(bytes(&still, false), (80 * vertices + 48 * 3, 0));
    assert_eq!(bytes(&still, true), (112 * vertices + 48 * 3, 2));
    let offsets: u64 = mesh.morphs.iter().map(|morph| morph.offsets.len() as u64).sum();
    assert_eq!(bytes(&mesh, false).0, (80 + 32) * vertices + 48 * 3 + 4 * (vertices + 1) + 32 * offsets + 16);
    // A groom without a body has no pass of one and no bytes.
    let strands = strands_of(random_asset(20, 8, 3), 0);
    let (mut backend, mut list) = (NullBackend::default(), PassList::new());
    let desc = SectionDesc::new(&strands, SimParams::default());
    let mut sim = HairSim::new(&mut backend, &mut list, &[desc], 0).unwrap();
    sim.step(&mut list, &StepInput::new(1.0 / 60.0, Pose::IDENTITY)).unwrap();
    let of_bodies = ["hair.sim.skin", "hair.sim.triangle_roots", "hair.sim.bone_roots", "hair.sim.roots"];
    assert!(list.labels().all(|label| !of_bodies.contains(&label)));
    assert!(backend.shaders.iter().all(|shader| !of_bodies.contains(&shader.label)));
}
