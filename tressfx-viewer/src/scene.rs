//! `viewer.scene`: opaque meshes and the backdrop, and the light of a studio.

use glam::Vec3;
use tressfx_asset::mesh::Mesh;
use tressfx_core::backend::{Backend, Blend, BufferDesc, Depth, DepthOrder, Format, RasterDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Count, Draw, Load, PassList, RasterPass};
use tressfx_core::shader::{Binding, Bindings, Module, RasterPipeline, Shader, ShaderSource, Specialization};
use tressfx_core::view::{Pose, View};
use tressfx_render::uniforms::ViewUniform;
use tressfx_render::{Light, Lights, SHADOW_MODULES, Targets, VIEW_MODULE};
use tressfx_sim::field::SurfaceBuffers;

const LABEL: &str = "viewer.scene";

/// How a mesh looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Linear RGB.
    pub color: Vec3,
    /// Brightness of the edge against the light, 0 to 1.
    pub rim: f32,
    /// Brightness of the highlight, 0 to 1.
    pub gloss: f32,
    /// How narrow the highlight is, 1 to 1000.
    pub exponent: f32,
    /// How far light creeps into the shadow, 0 to 1: more for skin.
    pub softness: f32,
}

impl Default for Surface {
    /// A tailor's dummy of dark clay: where hair is thin, it is seen between the strands, and no strand shades it.
    fn default() -> Self {
        Self { color: Vec3::new(0.15, 0.108, 0.088), rim: 0.05, gloss: 0.06, exponent: 22.0, softness: 0.3 }
    }
}

/// What is behind everything: linear RGB, from the middle of the picture to its edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backdrop {
    /// In the middle.
    pub middle: Vec3,
    /// At the edge.
    pub edge: Vec3,
}

impl Default for Backdrop {
    /// Grey-blue paper.
    fn default() -> Self {
        Self { middle: Vec3::new(0.30, 0.33, 0.36), edge: Vec3::new(0.05, 0.057, 0.07) }
    }
}

mod uniform {
    use super::gpu_struct;

    gpu_struct! {
        /// A mesh in a frame.
        pub(super) struct Surface {
            /// Where it is moved to, columns.
            pub pose: [[f32; 4]; 4],
            /// Its colour.
            pub color: [f32; 4],
            /// Rim, gloss, exponent, softness.
            pub look: [f32; 4],
        }
    }

    gpu_struct! {
        /// What is behind everything.
        pub(super) struct Backdrop {
            /// Colour in the middle.
            pub middle: [f32; 4],
            /// Colour at the edge.
            pub edge: [f32; 4],
            /// Pixels across and down.
            pub size: [f32; 2],
            /// The depth that nothing is behind.
            pub far: f32,
            /// Nothing.
            pub unused: f32,
        }
    }
}

/// A mesh on the GPU.
#[derive(Debug)]
pub struct SceneMesh {
    vertices: BufferId,
    indices: BufferId,
    uniform: BufferId,
    count: Count,
    /// What is freed with it; the others are of another part of the program.
    own: Vec<BufferId>,
}

/// A mesh in a frame.
#[derive(Clone, Copy, Debug)]
pub struct MeshDraw<'a> {
    /// The mesh.
    pub mesh: &'a SceneMesh,
    /// Its look.
    pub surface: Surface,
    /// Where it is moved to.
    pub pose: Pose,
}

/// What is opaque in a frame.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// What is behind everything.
    pub backdrop: Backdrop,
    /// What stands before it.
    pub meshes: &'a [MeshDraw<'a>],
    /// `HairRenderer::shadow_bindings` where the pass was made with shadows, else nothing.
    pub shadows: &'a [(&'static str, Binding)],
}

/// Draws what is not hair, so that hair has something to grow on and to hide behind.
#[derive(Debug)]
pub struct ScenePass {
    order: DepthOrder,
    mesh: RasterPipeline,
    backdrop: RasterPipeline,
    view: BufferId,
    gradient: BufferId,
}

impl ScenePass {
    /// Compiles the shaders for a colour target and an order of depth, with shadows of hair on the meshes or without.
    ///
    /// # Errors
    /// What the backend says.
    pub fn new(backend: &mut dyn Backend, target: Format, order: DepthOrder, has_shadows: bool) -> Result<Self> {
        let (target, depth) = ((target, Blend::Replace), Depth::TestWrite(order));
        let mesh = ("scene", include_str!("../shaders/scene.wgsl"));
        let backdrop = ("backdrop", include_str!("../shaders/backdrop.wgsl"));
        Ok(Self {
            order,
            mesh: raster(backend, LABEL, mesh, target, depth, has_shadows)?,
            backdrop: raster(backend, "viewer.backdrop", backdrop, target, depth, false)?,
            view: uniform_buffer::<ViewUniform>(backend, "viewer.scene.view")?,
            gradient: uniform_buffer::<uniform::Backdrop>(backend, "viewer.backdrop")?,
        })
    }

    /// Clears the targets and draws meshes before the backdrop.
    ///
    /// # Errors
    /// Shadows that are missing, or that nobody asked for.
    ///
    /// # Panics
    /// If the view has another order of depth than the pass.
    pub fn draw(
        &self,
        list: &mut PassList,
        view: &View,
        lights: &Lights,
        targets: &Targets,
        scene: &Scene,
    ) -> Result<()> {
        let Scene { backdrop, meshes, shadows } = scene;
        assert_eq!(view.depth(), self.order, "the order of depth of the view and of the scene pass");
        list.upload(self.view, 0, &[ViewUniform::new(view, lights)]);
        list.upload(self.gradient, 0, &[backdrop.uniform(view)]);
        meshes.iter().for_each(|mesh| mesh.upload(list));
        let mut pass = RasterPass::new(LABEL)
            .color(targets.color, Load::Clear(backdrop.edge.extend(1.0).to_array()))
            .depth(targets.depth, Load::Clear(self.order.far()));
        for draw in *meshes {
            pass = pass.draw(self.mesh(draw.mesh, shadows)?);
        }
        let gradient = self.backdrop.bind(&[("gradient", self.gradient.into())])?;
        list.raster(pass.draw(Draw::new(&self.backdrop, &gradient, 3, 1)));
        Ok(())
    }

    fn mesh(&self, mesh: &SceneMesh, shadows: &[(&'static str, Binding)]) -> Result<Draw> {
        let bindings = self.mesh.bind(&[&mesh.bindings(self.view.into())[..], shadows].concat())?;
        Ok(mesh.draw(&self.mesh, &bindings))
    }

    /// Frees what it made.
    pub fn destroy(self, backend: &mut dyn Backend) {
        [self.mesh, self.backdrop].into_iter().for_each(|kernel| backend.destroy_pipeline(kernel.pipeline));
        [self.view, self.gradient].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

impl SceneMesh {
    /// Uploads a mesh with the next run of `list`.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size.
    pub fn new(backend: &mut dyn Backend, list: &mut PassList, mesh: &Mesh) -> Result<Self> {
        let pairs = mesh.positions.iter().zip(&mesh.normals);
        let vertices: Vec<[f32; 4]> =
            pairs.flat_map(|(p, n)| [p.extend(1.0).to_array(), n.extend(0.0).to_array()]).collect();
        let mut buffer = |label, bytes: usize| backend.create_buffer(&BufferDesc::storage(label, bytes.max(32) as u64));
        let vertex_buffer = buffer("viewer.scene.vertices", size_of_val(&vertices[..]))?;
        let indices = buffer("viewer.scene.indices", size_of_val(&mesh.indices[..]))?;
        list.upload(vertex_buffer, 0, &vertices);
        list.upload(indices, 0, &mesh.indices);
        let count = Count::Direct { vertices: mesh.indices.len() as u32, instances: 1 };
        Self::of_buffers(backend, [vertex_buffer, indices], count, vec![vertex_buffer, indices])
    }

    /// A mesh whose vertices something else writes: two `vec4<f32>` each, position and normal. They are not freed with it.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size.
    pub fn of_vertices(
        backend: &mut dyn Backend,
        list: &mut PassList,
        vertices: BufferId,
        triangles: &[[u32; 3]],
    ) -> Result<Self> {
        let indices = triangles.as_flattened();
        let bytes = size_of_val(indices).max(32) as u64;
        let index_buffer = backend.create_buffer(&BufferDesc::storage("viewer.scene.indices", bytes))?;
        list.upload(index_buffer, 0, indices);
        let count = Count::Direct { vertices: indices.len() as u32, instances: 1 };
        Self::of_buffers(backend, [vertices, index_buffer], count, vec![index_buffer])
    }

    /// The surface of a field: how many triangles it has is known on the GPU. Its buffers are not freed with it.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer.
    pub fn of_surface(backend: &mut dyn Backend, surface: &SurfaceBuffers) -> Result<Self> {
        let count = Count::Indirect { buffer: surface.draw, offset: 0 };
        Self::of_buffers(backend, [surface.vertices, surface.indices], count, Vec::new())
    }

    fn of_buffers(
        backend: &mut dyn Backend,
        [vertices, indices]: [BufferId; 2],
        count: Count,
        mut own: Vec<BufferId>,
    ) -> Result<Self> {
        let uniform = uniform_buffer::<uniform::Surface>(backend, "viewer.scene.surface")?;
        own.push(uniform);
        Ok(Self { vertices, indices, uniform, count, own })
    }

    /// Draws all of it.
    pub(crate) fn draw(&self, pipeline: &RasterPipeline, bindings: &Bindings) -> Draw {
        match self.count {
            Count::Direct { vertices, instances } => Draw::new(pipeline, bindings, vertices, instances),
            Count::Indirect { buffer, offset } => Draw::indirect(pipeline, bindings, buffer, offset),
        }
    }

    pub(crate) fn bindings(&self, view: Binding) -> [(&'static str, Binding); 4] {
        [
            ("view", view),
            ("surface", self.uniform.into()),
            ("vertices", self.vertices.into()),
            ("indices", self.indices.into()),
        ]
    }

    /// Whether a buffer holds where it is moved to.
    #[cfg(test)]
    pub(crate) fn is_placed_by(&self, buffer: BufferId) -> bool {
        self.uniform == buffer
    }

    /// Frees it.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.own.into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

impl MeshDraw<'_> {
    /// What passes that draw it read: it has to come before each of them in a list.
    pub(crate) fn upload(&self, list: &mut PassList) {
        list.upload(self.mesh.uniform, 0, &[self.uniform()]);
    }

    fn uniform(&self) -> uniform::Surface {
        let Surface { color, rim, gloss, exponent, softness } = self.surface;
        uniform::Surface {
            pose: self.pose.matrix().to_cols_array_2d(),
            color: color.extend(1.0).to_array(),
            look: [rim, gloss, exponent, softness],
        }
    }
}

impl Backdrop {
    fn uniform(&self, view: &View) -> uniform::Backdrop {
        uniform::Backdrop {
            middle: self.middle.extend(1.0).to_array(),
            edge: self.edge.extend(1.0).to_array(),
            size: view.size().map(|side| side as f32),
            far: view.depth().far(),
            unused: 0.0,
        }
    }
}

/// A portrait studio for a subject that faces +z: a warm key light from the upper right, a cool fill from the left, and a
/// light from behind that draws the outline.
pub fn studio_lights() -> Lights {
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

fn raster(
    backend: &mut dyn Backend,
    label: Label,
    root: Module,
    target: (Format, Blend),
    depth: Depth,
    has_shadows: bool,
) -> Result<RasterPipeline> {
    const LIBRARY: [Module; 4] = [VIEW_MODULE, SHADOW_MODULES[0], SHADOW_MODULES[1], SHADOW_MODULES[2]];
    let source = ShaderSource { label, root, library: &LIBRARY };
    let shader = Shader::new(&source, &Specialization::new().feature("shadows", has_shadows))?.into();
    backend.create_raster(&RasterDesc::new(shader).target(target.0, target.1).depth(depth))
}

fn uniform_buffer<T>(backend: &mut dyn Backend, label: &'static str) -> Result<BufferId> {
    backend.create_buffer(&BufferDesc::uniform(label, size_of::<T>() as u64))
}

#[cfg(test)]
mod tests {
    use tressfx_core::null::NullBackend;

    use super::*;

    #[test]
    fn structs_are_laid_out_as_in_the_wgsl() {
        let pass = ScenePass::new(&mut NullBackend::default(), Format::Rgba16F, DepthOrder::Reverse, true).unwrap();
        pass.mesh.shader.check_layout::<ViewUniform>().unwrap();
        pass.mesh.shader.check_layout::<uniform::Surface>().unwrap();
        pass.backdrop.shader.check_layout::<uniform::Backdrop>().unwrap();
    }
}
