//! What the small engines show beside the hair: a bust and the floor that it stands on.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};
use tressfx_asset::builtin::Builtin;
use tressfx_core::strands::Bounds;
use tressfx_core::view::{Camera, Pose, View};
use tressfx_render::{LightPlace, Lights};
use tressfx_viewer::scene::studio_lights;

/// A vertex of the engines' own meshes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Position, and 1 where it moves with the head, 0 where it stays.
    pub position: Vec4,
    /// Unit normal, 0.
    pub normal: Vec4,
}

/// What the shader `stage.wgsl` is told in each frame.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Shade {
    view_projection: Mat4,
    head: Mat4,
    towards: Vec4,
    key: Vec4,
    sky: Vec4,
    ground: Vec4,
    /// Middle of the floor, and its radius.
    floor: Vec4,
}

/// Meshes, camera and light of the engines.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Of the bust and of the floor.
    pub vertices: Vec<Vertex>,
    /// Three a triangle.
    pub indices: Vec<u32>,
    /// The camera.
    pub view: View,
    /// The light, on the stage and on the hair.
    pub lights: Lights,
    floor: Vec4,
}

impl Stage {
    /// A stage for a groom.
    pub fn new(groom: &Builtin, size: [u32; 2]) -> Self {
        let bust = groom.mesh();
        let pairs = bust.positions.iter().zip(&bust.normals);
        let vertices = pairs.map(|(&p, &n)| Vertex { position: p.extend(1.0), normal: n.extend(0.0) }).collect();
        let bounds = Bounds::of(bust.positions.iter().copied());
        let points =
            groom.asset().points.iter().map(|&point| Vec3::from(point)).chain(bust.positions).collect::<Vec<_>>();
        let middle = bounds.center().with_y(bounds.min.y);
        let mut stage = Self {
            vertices,
            indices: bust.indices,
            view: Camera::around(&points, size).view(size).expect("a camera that sees its points"),
            lights: studio_lights(),
            floor: middle.extend(8.0 * bounds.radius()),
        };
        stage.lay_floor();
        stage
    }

    fn lay_floor(&mut self) {
        let first = self.vertices.len() as u32;
        let corner = |x: f32, z: f32| Vertex {
            position: (self.floor.truncate() + Vec3::new(x, 0.0, z) * self.floor.w).extend(0.0),
            normal: Vec4::Y,
        };
        self.vertices.extend([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]);
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|index| first + index));
    }

    /// What the shader is told with the head at `head`.
    pub fn shade(&self, head: &Pose) -> Shade {
        let key = self.lights.lights[0];
        let towards = match key.place {
            LightPlace::Directional { towards } => towards.normalize(),
            LightPlace::Point { position, .. } => (position - self.floor.truncate()).normalize(),
        };
        Shade {
            view_projection: self.view.view_projection(),
            head: head.matrix(),
            towards: towards.extend(0.0),
            key: key.color.extend(0.0),
            sky: self.lights.sky.extend(0.0),
            ground: self.lights.ground.extend(0.0),
            floor: self.floor,
        }
    }
}
