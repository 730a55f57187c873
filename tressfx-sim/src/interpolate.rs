//! Render strands between guides: few strands are simulated, and many are drawn.
//!
//! Each render strand lies in a triangle of three guides. Its root is at barycentric coordinates of theirs, its edges are the mean of theirs, with the mean length. None is stored:
//! [`Interpolation::record`] makes those that a frame draws, from where the guides are, into [`StrandBuffers`] that a renderer takes as it takes those of the simulation.
//! 32 bytes a strand say which guides it has.

mod desc;
mod scatter;
mod triangles;

use std::sync::Arc;

use glam::{DVec3, UVec3, Vec2};
use rayon::prelude::*;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::backend::{Backend, BufferDesc, ComputeDesc, Owner};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Bindings, Kernel, Shader, Specialization};
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::{StrandOptions, Strands, StrandsError};

use crate::buffers::storage;
use crate::error::SimError;
use crate::kernel::{GROUP, interpolate};
use crate::reference;
pub use desc::InterpolationParams;
use scatter::Guides;

/// Strands of which a sample has at most so many.
const SAMPLE: u32 = 4096;

gpu_struct! {
    /// A strand and its guides, the nearest first.
    pub struct BetweenGuides {
        /// The guides.
        pub guides: UVec3,
        /// The share of the guides' length that it has.
        pub length: f32,
        /// What the second and the third guide have of its root; the first has the rest.
        pub root_shares: Vec2,
        /// The same for its edges.
        pub edge_shares: Vec2,
    }
}

gpu_struct! {
    /// How strands are made: [`InterpolationParams`] with counts.
    pub struct InterpolationUniform {
        /// Strands of the buffer that holds the guides.
        pub guide_strands: u32,
        /// Vertices of a guide.
        pub guide_vertices: u32,
        /// Strands of the buffers that are written.
        pub strands: u32,
        /// Vertices of each.
        pub vertices: u32,
        /// How many of the strands are written.
        pub drawn: u32,
        /// [`InterpolationParams::clump`].
        pub clump: f32,
        /// [`InterpolationParams::clump_falloff`].
        pub clump_falloff: f32,
        /// [`InterpolationParams::noise`].
        pub noise: f32,
        /// [`InterpolationParams::noise_waves`].
        pub noise_waves: f32,
        /// Nothing.
        pub padding_a: f32,
        /// Nothing.
        pub padding_b: f32,
        /// Nothing.
        pub padding_c: f32,
    }
}

/// Render strands between the guides of a section, and the kernel that makes them.
#[derive(Debug)]
pub struct Interpolation {
    buffers: StrandBuffers,
    kernel: Kernel,
    bindings: Bindings,
    uniform: BufferId,
    values: InterpolationUniform,
    between: Vec<BetweenGuides>,
    owner: Owner,
}

impl Interpolation {
    /// Scatters so many strands between the guides of a section, and uploads what says where. `guides` are its buffers ([`HairSim::buffers`](crate::HairSim::buffers)), made from `strands`.
    ///
    /// It takes 32 bytes a strand, and 36 a vertex of it for positions, tangents and thickness.
    ///
    /// # Errors
    /// A parameter outside its range, no strands or 2^32 vertices or more, guides of other counts, guides between which there is no triangle (fewer than three, or all on a line), or what the backend
    /// says.
    pub fn new(
        backend: &mut dyn Backend,
        list: &mut PassList,
        (guides, strands): (&StrandBuffers, &Strands),
        count: u32,
        params: &InterpolationParams,
    ) -> Result<Self, SimError> {
        params.validate()?;
        let vertices = params.vertices.unwrap_or(strands.vertices);
        if count == 0 || count.checked_mul(vertices).is_none() {
            return Err(SimError::RenderStrands { strands: count, vertices });
        }
        let scattered = Guides::new(strands);
        if !scattered.has_triangles() || guides.shape != StrandShape::of(strands) {
            return Err(SimError::NoTriangles { name: strands.name.clone(), guides: strands.guides });
        }
        let between: Vec<BetweenGuides> =
            (0..count).into_par_iter().map(|index| scattered.strand(params, index)).collect();
        let shape = StrandShape { guides: count, follows: 0, vertices };
        let values = uniform(guides.shape, shape, params);
        let specialization = Specialization::new()
            .feature("spline", vertices != strands.vertices || params.shorter > 0.0)
            .feature("clump", params.clump > 0.0)
            .feature("noise", params.noise > 0.0);
        let ((kernel, bindings, uniform, buffers, entries), owner) = Owner::build(backend, |backend| {
            let buffers = StrandBuffers::new(backend, shape, guides.center)?;
            let uniform = BufferDesc::uniform("hair.interpolation", size_of::<InterpolationUniform>() as u64);
            let uniform = backend.create_buffer(&uniform)?;
            let entries = storage(backend, "hair.between_guides", size_of::<BetweenGuides>() as u64, count)?;
            let shader = Arc::new(Shader::new(&interpolate::SOURCE, &specialization)?);
            let kernel = backend.create_compute(&ComputeDesc::new(shader))?;
            let bindings = kernel.bind(&[
                ("interpolation", uniform.into()),
                ("guides", guides.positions.into()),
                ("between_guides", entries.into()),
                ("positions", buffers.positions.into()),
                ("strand_tangents", buffers.tangents.into()),
            ])?;
            Ok::<_, tressfx_core::Error>((kernel, bindings, uniform, buffers, entries))
        })?;
        list.upload(entries, 0, &between);
        list.upload(buffers.thickness, 0, &thickness(shape));
        Ok(Self { buffers, kernel, bindings, uniform, values, between, owner })
    }

    /// Makes the first strands from where the guides are: one pass. It comes behind [`HairSim::step`](crate::HairSim::step) and before what draws them. Who draws all of them gives the
    /// number of all; with less detail give what a renderer needs of them (`SectionDraw::needed_strands`). Nothing is recorded for none.
    pub fn record(&self, list: &mut PassList, strands: u32) {
        let drawn = strands.min(self.values.strands);
        if drawn > 0 {
            list.upload(self.uniform, 0, &[InterpolationUniform { drawn, ..self.values }]);
            list.compute(&self.kernel, &self.bindings, Grid::for_threads(drawn, GROUP));
        }
    }

    /// What it makes, for a renderer: positions are in the space of those of the guides, and no strand follows another.
    pub fn buffers(&self) -> &StrandBuffers {
        &self.buffers
    }

    /// Which guides each strand has.
    pub fn between(&self) -> &[BetweenGuides] {
        &self.between
    }

    /// What its kernel is given.
    pub fn uniform(&self) -> &InterpolationUniform {
        &self.values
    }

    /// The rest pose of an even sample of the strands, for what a renderer wants to know of it: the first 4,096.
    ///
    /// # Errors
    /// As [`Interpolation::rest`].
    pub fn sample(&self, guides: &Strands) -> Result<Strands, StrandsError> {
        self.rest(guides, SAMPLE)
    }

    /// The rest pose of the first strands, in f64, with the texture coordinates, colours and widths of their nearest guides. `guides` are those that it was made with.
    ///
    /// # Errors
    /// Strands that cannot be made, such as those of lengths that are not finite.
    pub fn rest(&self, guides: &Strands, most: u32) -> Result<Strands, StrandsError> {
        let of_guides: Vec<Vec<DVec3>> = guides
            .rest
            .chunks(guides.vertices as usize)
            .map(|guide| guide.iter().map(|vertex| vertex.truncate().as_dvec3()).collect())
            .collect();
        let between = &self.between[..self.between.len().min(most as usize)];
        let points = between.par_iter().enumerate().flat_map_iter(|(index, strand)| {
            let trio = strand.guides.to_array().map(|guide| of_guides[guide as usize].as_slice());
            let made = reference::interpolate(&self.values, strand, index as u32, trio);
            made.into_iter().map(|point| point.as_vec3().to_array())
        });
        let counts = vec![self.values.vertices; between.len()];
        let mut asset = HairAsset::new(guides.name.clone(), AssetFormat::Builtin, points.collect(), counts);
        let nearest = || between.iter().map(|strand| strand.guides.x as usize);
        asset.strand_uvs = guides.strand_uv.as_ref().map(|uvs| nearest().map(|guide| uvs[guide].to_array()).collect());
        let vertices =
            || nearest().zip(between).flat_map(|(guide, strand)| self.nearest_vertices(guide, strand.length));
        asset.vertex_colors =
            guides.vertex_colors.as_ref().map(|colors| vertices().map(|vertex| colors[vertex].to_array()).collect());
        asset.vertex_thickness =
            guides.vertex_widths.as_ref().map(|widths| vertices().map(|vertex| widths[vertex]).collect());
        let options = StrandOptions {
            vertices: Some(self.values.vertices),
            follows: Some(0),
            shuffle: false,
            metres_per_unit: Some(guides.metres_per_unit),
            ..StrandOptions::default()
        };
        Strands::new(&asset, &options)
    }

    /// The vertices of a guide that are nearest to those of a strand.
    fn nearest_vertices(&self, guide: usize, length: f32) -> impl Iterator<Item = usize> + use<> {
        let InterpolationUniform { guide_vertices, vertices, .. } = self.values;
        let step = length * (guide_vertices - 1) as f32 / (vertices - 1) as f32;
        let at = move |vertex: u32| ((vertex as f32 * step).round() as usize).min(guide_vertices as usize - 1);
        (0..vertices).map(move |vertex| guide * guide_vertices as usize + at(vertex))
    }

    /// Frees everything.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.buffers.destroy(backend);
        self.owner.destroy(backend);
    }
}

fn uniform(guides: StrandShape, shape: StrandShape, params: &InterpolationParams) -> InterpolationUniform {
    InterpolationUniform {
        guide_strands: guides.strands(),
        guide_vertices: guides.vertices,
        strands: shape.guides,
        vertices: shape.vertices,
        drawn: shape.guides,
        clump: params.clump,
        clump_falloff: params.clump_falloff,
        noise: params.noise,
        noise_waves: params.noise_waves,
        padding_a: 0.0,
        padding_b: 0.0,
        padding_c: 0.0,
    }
}

/// Shares of the full width, as strands that are simulated have them, with edges of one length.
fn thickness(shape: StrandShape) -> Vec<f32> {
    let share = |vertex: u32| vertex as f32 / (shape.vertices - 1) as f32;
    let width = |vertex: u32| (1.0 - share(vertex) * share(vertex)).max(0.0).sqrt();
    (0..shape.vertices).flat_map(|vertex| std::iter::repeat_n(width(vertex), shape.guides as usize)).collect()
}
