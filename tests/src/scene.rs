//! Opaque meshes for pictures of hair: something to hide behind, and something to hide.

use glam::{Mat4, Vec3};
use tressfx_asset::mesh::Mesh;
use tressfx_core::backend::{Backend, Blend, BufferDesc, BufferUses, Depth, DepthOrder, Format, RasterDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Draw, Load, PassList, RasterPass};
use tressfx_core::shader::{RasterPipeline, Shader, ShaderSource, Specialization};
use tressfx_core::view::View;
use tressfx_render::{Light, Lights, ShadowDesc, Targets};

const LABEL: Label = "test.scene";

const SHADER: &str = "
struct Place { matrix: mat4x4<f32> }
@group(0) @binding(0) var<uniform> place: Place;
// Position and normal of each vertex.
@group(0) @binding(1) var<storage, read> vertices: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> indices: array<u32>;
struct Varying { @builtin(position) position: vec4<f32>, @location(0) normal: vec3<f32> }
@vertex fn corner(@builtin(vertex_index) i: u32) -> Varying {
    let vertex = indices[i];
    return Varying(place.matrix * vec4(vertices[2u * vertex].xyz, 1.0), vertices[2u * vertex + 1u].xyz);
}
@fragment fn clay(in: Varying) -> @location(0) vec4<f32> {
    let light = 0.5 + 0.5 * dot(normalize(in.normal), vec3(0.48, 0.64, 0.6));
    return vec4(light * vec3(0.15, 0.11, 0.09), 1.0);
}";

gpu_struct! {
    /// Where meshes are.
    struct Place {
        /// Their space to clip, columns.
        pub matrix: [[f32; 4]; 4],
    }
}

/// A mesh on the GPU.
#[derive(Debug)]
pub struct SceneMesh {
    vertices: BufferId,
    indices: BufferId,
    place: BufferId,
    index_count: u32,
}

impl SceneMesh {
    /// Uploads a mesh with the next run of `list`.
    ///
    /// # Errors
    /// What the backend says.
    pub fn new(backend: &mut dyn Backend, list: &mut PassList, mesh: &Mesh) -> Result<Self> {
        let pairs = mesh.positions.iter().zip(&mesh.normals);
        let vertices: Vec<[f32; 4]> =
            pairs.flat_map(|(p, n)| [p.extend(1.0).to_array(), n.extend(0.0).to_array()]).collect();
        let mut buffer = |label, bytes: usize, uses| {
            backend.create_buffer(&BufferDesc::new(label, bytes.max(32) as u64, uses | BufferUses::COPIES))
        };
        let made = Self {
            vertices: buffer("test.scene.vertices", size_of_val(&vertices[..]), BufferUses::STORAGE)?,
            indices: buffer("test.scene.indices", size_of_val(&mesh.indices[..]), BufferUses::STORAGE)?,
            place: buffer("test.scene.place", size_of::<Place>(), BufferUses::UNIFORM)?,
            index_count: mesh.indices.len() as u32,
        };
        list.upload(made.vertices, 0, &vertices);
        list.upload(made.indices, 0, &mesh.indices);
        Ok(made)
    }

    /// Frees its buffers.
    pub fn destroy(self, backend: &mut dyn Backend) {
        [self.vertices, self.indices, self.place].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

/// Clears the targets and draws meshes.
#[derive(Debug)]
pub struct ScenePass {
    order: DepthOrder,
    pipeline: RasterPipeline,
}

impl ScenePass {
    /// For a colour target and an order of depth.
    ///
    /// # Errors
    /// What the backend says.
    pub fn new(backend: &mut dyn Backend, target: Format, order: DepthOrder) -> Result<Self> {
        let source = ShaderSource { label: LABEL, root: ("scene", SHADER), library: &[] };
        let shader = Shader::new(&source, &Specialization::new())?.into();
        let desc = RasterDesc::new(shader).target(target, Blend::Replace).depth(Depth::TestWrite(order));
        Ok(Self { order, pipeline: backend.create_raster(&desc)? })
    }

    /// The meshes with the head at `head`, over grey. Targets are as large as the view's viewport.
    pub fn draw(&self, list: &mut PassList, view: &View, head: Mat4, targets: &Targets, meshes: &[SceneMesh]) {
        let matrix = (view.view_projection() * head).to_cols_array_2d();
        let mut pass = RasterPass::new(LABEL)
            .color(targets.color, Load::Clear([0.1, 0.11, 0.12, 1.0]))
            .depth(targets.depth, Load::Clear(self.order.far()));
        for mesh in meshes {
            list.upload(mesh.place, 0, &[Place { matrix }]);
            let bindings = self.pipeline.bind(&[
                ("place", mesh.place.into()),
                ("vertices", mesh.vertices.into()),
                ("indices", mesh.indices.into()),
            ]);
            let bindings = bindings.expect("the names of the shader");
            pass = pass.draw(Draw::new(&self.pipeline, &bindings, mesh.index_count, 1));
        }
        list.raster(pass);
    }
}

/// Shadows with few cells: on a CPU the usual ones take longer than the hair of small scenes.
pub fn coarse_shadows() -> ShadowDesc {
    ShadowDesc::default().texels(96, 32).cells(24)
}

/// Light from three sides.
pub fn lights() -> Lights {
    Lights {
        sky: Vec3::new(0.22, 0.24, 0.28),
        ground: Vec3::new(0.09, 0.08, 0.07),
        lights: vec![
            Light::directional(Vec3::new(0.75, 0.8, 0.75), Vec3::new(2.3, 2.1, 1.85)),
            Light::directional(Vec3::new(-0.9, 0.25, 0.6), Vec3::new(0.35, 0.42, 0.55)),
            Light::directional(Vec3::new(-0.45, 0.65, -0.9), Vec3::new(1.1, 1.2, 1.4)),
        ],
    }
}
