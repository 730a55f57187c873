//! `viewer.light_depth`: what the lights of the studio see of the opaque meshes, for their shadows on hair.

use glam::camera::rh;
use glam::{Mat4, Vec3};
use tressfx_asset::mesh::Mesh;
use tressfx_core::backend::{Backend, Depth, DepthOrder, Format, RasterDesc, TextureDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Draw, Load, PassList, RasterPass};
use tressfx_core::shader::{RasterPipeline, Shader, ShaderSource, Specialization};
use tressfx_core::strands::Bounds;
use tressfx_core::uniform_array::UniformArray;
use tressfx_core::view::{Pose, View};
use tressfx_render::uniforms::ViewUniform;
use tressfx_render::{Light, LightPlace, Lights, MAX_LIGHTS, OpaqueDepth, VIEW_MODULE};

use crate::scene::MeshDraw;

const LABEL: Label = "viewer.light_depth";

/// Pixels of what a light sees, each way.
const TEXELS: u32 = 1024;

/// Texels that hair may be behind a surface and still be lit: its surface is flat between the texels.
const BIAS: f32 = 2.0;

/// The depth of the scene as each directional light sees it.
#[derive(Debug)]
pub struct LightDepth {
    pipeline: RasterPipeline,
    views: UniformArray<ViewUniform>,
    textures: Vec<TextureId>,
    /// Around all meshes, with the head in its rest pose.
    sphere: (Vec3, f32),
}

impl LightDepth {
    /// Compiles the shader, and makes a texture for each light that casts a shadow.
    ///
    /// # Errors
    /// What the backend says.
    pub fn new(backend: &mut dyn Backend, lights: &Lights, meshes: &[Mesh]) -> Result<Self> {
        let root = ("scene_depth", include_str!("../shaders/scene_depth.wgsl"));
        let source = ShaderSource { label: LABEL, root, library: &[VIEW_MODULE] };
        let shader = Shader::new(&source, &Specialization::new())?.into();
        let depth = Depth::TestWrite(DepthOrder::Standard);
        let desc = TextureDesc::new(LABEL, [TEXELS; 2], Format::Depth32F);
        let casting = lights.lights.iter().filter(|light| way_of(light).is_some());
        let textures = if meshes.is_empty() { 0 } else { casting.count() };
        let bounds = Bounds::of(meshes.iter().flat_map(|mesh| &mesh.positions).copied());
        Ok(Self {
            pipeline: backend.create_raster(&RasterDesc::new(shader).depth(depth))?,
            views: UniformArray::new(backend, LABEL, MAX_LIGHTS)?,
            textures: (0..textures).map(|_| backend.create_texture(&desc)).collect::<Result<_>>()?,
            sphere: (bounds.center(), 0.5 * (bounds.max - bounds.min).length()),
        })
    }

    /// Draws what the lights see of the meshes, which are all moved by `head`. Gives the lights back with what they see.
    ///
    /// # Errors
    /// None that can be reached: the names of bindings are those of the shader.
    pub fn draw(&self, list: &mut PassList, lights: &Lights, meshes: &[MeshDraw], head: Pose) -> Result<Lights> {
        let mut lit = lights.clone();
        meshes.iter().for_each(|mesh| mesh.upload(list));
        let casting = lit.lights.iter_mut().filter_map(|light| Some((way_of(light)?, light)));
        for (index, ((way, light), &depth)) in casting.zip(&self.textures).enumerate() {
            let Some(view) = self.view(way, head) else { continue };
            self.views.upload(list, index, &[ViewUniform::new(&view, &Lights::default())]);
            let mut pass = RasterPass::new(LABEL).depth(depth, Load::Clear(DepthOrder::Standard.far()));
            for MeshDraw { mesh, .. } in meshes {
                let bindings = self.pipeline.bind(&mesh.bindings(self.views.binding(index)))?;
                pass = pass.draw(Draw::new(&self.pipeline, &bindings, mesh.index_count, 1));
            }
            list.raster(pass);
            let bias = BIAS * 2.0 * self.sphere.1 / TEXELS as f32;
            *light = light.opaque(OpaqueDepth { depth, view, bias });
        }
        Ok(lit)
    }

    /// From the direction of a light, around the meshes.
    fn view(&self, way: Vec3, head: Pose) -> Option<View> {
        let (middle, radius) = (head.transform(self.sphere.0), self.sphere.1);
        let up = if way.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
        let to_light: Mat4 = rh::view::look_to_mat4(middle - 2.0 * radius * way, way, up);
        let reach = 1.01 * radius;
        let lens = rh::proj::directx::orthographic(-reach, reach, -reach, reach, 0.5 * radius, 3.5 * radius);
        View::new(to_light, lens, DepthOrder::Standard, [TEXELS; 2]).ok()
    }
}

/// The way of a light that casts from a direction.
fn way_of(light: &Light) -> Option<Vec3> {
    match light.place {
        LightPlace::Directional { towards } if light.casts => (-towards).try_normalize(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use tressfx_core::null::NullBackend;
    use tressfx_core::pass::Command;
    use tressfx_core::shape::Ellipsoid;

    use super::*;
    use crate::scene::{SceneMesh, Surface, studio_lights};

    #[test]
    fn lights_see_meshes_where_they_are_in_this_frame() {
        let mut backend = NullBackend::default();
        let ball = Mesh::ellipsoid(&Ellipsoid { center: Vec3::ZERO, radii: Vec3::ONE }, 8);
        let mesh = SceneMesh::new(&mut backend, &mut PassList::new(), &ball).unwrap();
        let lights = studio_lights();
        let depth = LightDepth::new(&mut backend, &lights, &[ball]).unwrap();
        let mut list = PassList::new();
        let meshes = [MeshDraw { mesh: &mesh, surface: Surface::default(), pose: Pose::IDENTITY }];
        let lit = depth.draw(&mut list, &lights, &meshes, Pose::IDENTITY).unwrap();
        assert!(lit.lights.iter().all(|light| light.opaque.is_some()));
        let first = list.commands().iter().position(Command::is_pass).unwrap();
        let is_place = |command: &Command| matches!(command, Command::Upload { dst, .. } if mesh.is_placed_by(*dst));
        assert!(list.commands()[..first].iter().any(is_place), "the place of the mesh comes before what draws it");
    }
}
