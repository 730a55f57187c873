//! Sections of strands for the renderer, with what shading and drawing need.

use glam::Vec3;
use tressfx_core::backend::{Backend, BufferDesc, Owner};
use tressfx_core::error::{Error, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::Binding;
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;

use crate::copies::{MAX_COPIES, drawn_shape, moved_aside};
use crate::draw_error::DrawError;
use crate::lod::{Bends, Lod};
use crate::material::Material;
use crate::own_look::{OwnBuffers, OwnLook};
use crate::reach;
use crate::scattering::ENTRIES;
use crate::shaders::GROUP;
use crate::uniforms::{LodUniform, SectionUniform};
use crate::velocity::Past;
use crate::views::BoundView;

/// How many segments a prediction samples.
const MAX_SAMPLES: usize = 4096;

/// So many layers of hair make the groom look dense.
const DENSE_LAYERS: f64 = 9.0;

/// The smallest fitting radius in metres: that of thick human hair.
const MIN_FITTING_RADIUS: f64 = 0.000_06;

/// The largest fitting radius in metres: thicker strands do not look like hair.
const MAX_FITTING_RADIUS: f64 = 0.000_4;

/// What rendering needs to know of a section beside its buffers.
#[derive(Clone, Debug, PartialEq)]
pub struct StrandInfo {
    /// Metres that a unit of the positions stands for.
    pub metres_per_unit: f32,
    /// Radius of a fibre in metres with which the strands cover the groom well: for a [`Material`] that gives none.
    pub fitting_radius: f32,
    /// An even sample of the segments of the rest pose: both ends, and the shares of the full width there. From it the
    /// number of fragments is predicted.
    pub sample: Vec<([Vec3; 2], [f32; 2])>,
    /// How far strands bend away from fewer vertices.
    pub bends: Bends,
    /// A point of the rest pose and a distance from it, in the unit of the positions, that no strand leaves however its head turns and it swings.
    /// Sections that no view can see are left out by it. [`StrandInfo::new`] takes roots to ride on the head, and follow strands to spread as the strands say: who
    /// moves roots away from the head gives more, or an infinite distance, with which a section is always drawn.
    pub reach: (Vec3, f32),
}

impl StrandInfo {
    /// What there is to know of a groom.
    pub fn new(strands: &Strands) -> Self {
        let vertices = strands.vertices as usize;
        let segments = strands.guides as usize * (vertices - 1);
        let segment = |i: usize| {
            let start = i / (vertices - 1) * vertices + i % (vertices - 1);
            let ends = [start, start + 1];
            (ends.map(|end| strands.rest[end].truncate()), ends.map(|end| strands.thickness[end]))
        };
        let count = segments.min(MAX_SAMPLES);
        let sample = (0..count).map(|i| segment(sampled(i, count, segments))).collect();
        Self {
            metres_per_unit: strands.metres_per_unit,
            fitting_radius: fitting_radius(strands, f64::from(strands.strand_count())),
            sample,
            bends: Bends::of(strands),
            reach: reach::of(strands),
        }
    }

    /// What there is to know of strands that are made each frame between `guides`, so many; `sample` is the rest pose of an even sample of them. What is between guides reaches
    /// no further than they do.
    pub fn between(guides: &Strands, sample: &Strands, strands: u32) -> Self {
        let share = f64::from(strands) / f64::from(sample.guides.max(1));
        Self {
            fitting_radius: fitting_radius(sample, f64::from(sample.strand_count()) * share),
            reach: reach::of(guides),
            ..Self::new(sample)
        }
    }

    /// Radius of a fibre in the unit of the positions. One that is fitted is shared by the copies, down to [`MIN_FITTING_RADIUS`].
    pub(crate) fn radius(&self, material: &Material) -> f32 {
        let fitting = || match material.copies {
            0 | 1 => self.fitting_radius,
            copies => (self.fitting_radius / copies as f32).max(MIN_FITTING_RADIUS as f32),
        };
        material.fibre_radius.unwrap_or_else(fitting) / self.metres_per_unit
    }
}

/// The segment of sample `i` of `count`: each is taken from its own part of all segments, at places that do not repeat. With equal
/// steps a groom whose strands are a multiple of the samples would be known by the first segments of its strands alone.
fn sampled(i: usize, count: usize, segments: usize) -> usize {
    let golden = (i as f64 * 0.618_033_988_749_894_9).fract();
    (((i as f64 + golden) * segments as f64 / count as f64) as usize).min(segments - 1)
}

/// The radius with which so many strands as long as these would cover the sides of the groom's bounds [`DENSE_LAYERS`] times, clamped to between
/// [`MIN_FITTING_RADIUS`] and [`MAX_FITTING_RADIUS`].
fn fitting_radius(strands: &Strands, count: f64) -> f32 {
    let extent = (strands.bounds.max - strands.bounds.min) * strands.metres_per_unit;
    let sides = (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x) / 3.0;
    let length: f64 = strands.rest_lengths.iter().map(|&length| f64::from(length)).sum();
    let length = length * f64::from(strands.metres_per_unit) * (count / f64::from(strands.guides.max(1)));
    let radius = DENSE_LAYERS * f64::from(sides) / (2.0 * length.max(1e-9));
    radius.clamp(MIN_FITTING_RADIUS, MAX_FITTING_RADIUS) as f32
}

/// The middle of the samples' bounds, and the distance of the sample that is farthest from it.
fn sphere(info: &StrandInfo) -> (Vec3, f32) {
    let points = || info.sample.iter().flat_map(|(ends, _)| ends).copied().filter(|point| point.is_finite());
    let Some(low) = points().reduce(Vec3::min) else { return (Vec3::ZERO, 0.0) };
    let high = points().fold(low, Vec3::max);
    let middle = low.midpoint(high);
    (middle, points().map(|point| point.distance(middle)).fold(0.0, f32::max))
}

/// The strands of a section with what shading needs, and the colours that it gives them.
#[derive(Debug)]
pub struct ShadedStrands {
    pub(crate) buffers: StrandBuffers,
    pub(crate) info: StrandInfo,
    /// [`SectionUniform`].
    pub(crate) uniform: BufferId,
    /// `vec2<u32>` a vertex of every strand: four half floats, colour and opacity.
    pub(crate) colors: BufferId,
    /// `vec4<u32>` a vertex of every strand: what arrives of the sky and of each light, see `shadow_light.wgsl`.
    pub(crate) arriving: BufferId,
    /// What shaders look up of a fibre that scatters as glass.
    pub(crate) fibre_table: BufferId,
    /// A point and a distance from it within which the samples of the rest pose lie, relative to the centre of the buffers.
    pub(crate) sphere: (Vec3, f32),
    /// How far from the centre of the buffers a strand may be.
    pub(crate) reach: f32,
    /// Where the strands were in the frame before, where that is kept.
    pub(crate) past: Option<Past>,
    /// Colours and widths that they bring along.
    own: Option<OwnBuffers>,
    owner: Owner,
}

impl ShadedStrands {
    /// Makes what rendering needs beside `buffers`, which stay the caller's.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size.
    pub fn new(backend: &mut dyn Backend, buffers: StrandBuffers, mut info: StrandInfo) -> Result<Self> {
        let made = Owner::build(backend, |backend| {
            let uniform = BufferDesc::uniform("hair.render.section", size_of::<SectionUniform>() as u64);
            let uniform = backend.create_buffer(&uniform)?;
            let table = BufferDesc::storage("hair.render.fibre_table", 16 * ENTRIES as u64);
            Ok::<_, Error>((uniform, lit(backend, buffers.shape)?, backend.create_buffer(&table)?))
        });
        let ((uniform, [colors, arriving], fibre_table), owner) = made?;
        info.sample.iter_mut().flat_map(|(ends, _)| ends).for_each(|end| *end -= buffers.center);
        let sphere = sphere(&info);
        // The head turns around the centre of the buffers.
        let reach = info.reach.0.distance(buffers.center) + info.reach.1;
        Ok(Self { buffers, info, uniform, colors, arriving, fibre_table, sphere, reach, past: None, own: None, owner })
    }

    /// The same with room for the positions of the frame before, 16 bytes a vertex: for renderers that write the motion of hair, see
    /// [`RenderDesc::velocity_output`](crate::RenderDesc::velocity_output).
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size; the strands are freed then.
    pub fn with_past(self, backend: &mut dyn Backend) -> Result<Self> {
        match Past::new(backend, &self.buffers) {
            Ok(past) => Ok(Self { past: Some(past), ..self }),
            Err(error) => {
                self.destroy(backend);
                Err(error)
            }
        }
    }

    /// The same with colours and widths of their own, which are uploaded with the next run of `list`: 8 bytes a vertex of every guide for colours, 4 for widths.
    /// Widths follow the `tip_width` of the material that they are drawn with: the frame in which it changes uploads them again.
    /// Colours need a renderer that knows of them, see [`RenderDesc::own_colors`](crate::RenderDesc::own_colors). An empty look changes nothing, another one takes the
    /// place of the one before.
    ///
    /// # Errors
    /// A look of other strands, by their counts, or what the backend says when it cannot make a buffer of that size; the strands are freed then.
    pub fn with_own_look(mut self, backend: &mut dyn Backend, list: &mut PassList, look: &OwnLook) -> Result<Self> {
        if look.is_empty() {
            return Ok(self);
        }
        let vertices = self.buffers.shape.guide_vertices() as usize;
        let made = match look.lengths().find(|&length| length != vertices) {
            Some(length) => Err(other_strands(length, vertices)),
            None => self.renew(backend).and_then(|()| OwnBuffers::new(backend, list, look)),
        };
        match made {
            Ok(own) => {
                self.own.take().into_iter().for_each(|before| before.destroy(backend));
                Ok(Self { own: Some(own), ..self })
            }
            Err(error) => {
                self.destroy(backend);
                Err(error)
            }
        }
    }

    /// Makes the buffers anew by which renderers know what they have bound.
    fn renew(&mut self, backend: &mut dyn Backend) -> Result<()> {
        let (before, shape) = ([self.colors, self.arriving], self.buffers.shape);
        [self.colors, self.arriving] = self.owner.change(backend, |backend| {
            let made = lit(backend, shape)?;
            before.into_iter().for_each(|buffer| backend.destroy(buffer.into()));
            Ok::<_, Error>(made)
        })?;
        Ok(())
    }

    /// Ends a frame: writes a copy of the positions, for the motion of the next frame. `pose` is the one that they were drawn with. It comes behind
    /// the last pass that draws them, and before they are simulated again.
    ///
    /// # Errors
    /// [`DrawError::NoPast`] if the strands have no room for it.
    pub fn keep_past(&mut self, list: &mut PassList, pose: Pose) -> std::result::Result<(), DrawError> {
        pose.validate()?;
        self.past.as_mut().ok_or(DrawError::NoPast)?.keep(list, &self.buffers, pose);
        Ok(())
    }

    /// Forgets where the strands were: in the next frame hair moves as the camera does, and by itself not at all. For a groom that has teleported or
    /// was put to rest (`StepReport::reset`), or that was not drawn in the frame before.
    pub fn forget_past(&mut self) {
        self.past.iter_mut().for_each(Past::forget);
    }

    /// Colours that they bring along, `vec2<u32>` a vertex of every guide: linear RGB and opacity as four half floats. An engine may write them with passes of its own.
    pub fn own_colors(&self) -> Option<BufferId> {
        self.own.as_ref()?.colors
    }

    /// Shares of the full width that they bring along, with the taper of a material: in the place of [`StrandBuffers::thickness`], for tools.
    pub fn own_thickness(&self, material: &Material) -> Option<Vec<f32>> {
        self.own.as_ref()?.shares(material)
    }

    /// Shares of the full width.
    pub(crate) fn thickness(&self) -> BufferId {
        self.own.as_ref().and_then(|own| own.thickness).unwrap_or(self.buffers.thickness)
    }

    /// Radius of the thickest fibre in the unit of the positions.
    pub(crate) fn radius(&self, material: &Material) -> f32 {
        self.info.radius(material) * self.own.as_ref().map_or(1.0, |own| own.widest)
    }

    /// What the module `strands` of the shaders binds.
    pub(crate) fn bindings(&self, view: &BoundView, scene_depth: TextureId) -> [(&'static str, Binding); 6] {
        [
            ("view", view.uniform),
            ("section", self.uniform.into()),
            ("positions", self.buffers.positions.into()),
            ("colors", self.colors.into()),
            ("thickness", self.thickness().into()),
            ("scene_depth", scene_depth.into()),
        ]
    }

    /// Colours as `hair.render.shade` leaves them: for tests and tools.
    pub fn colors(&self) -> BufferId {
        self.colors
    }

    /// What arrives at each vertex of the sky and of each light, as `hair.render.shadow_light` leaves it: for tests and tools.
    pub fn arriving(&self) -> BufferId {
        self.arriving
    }

    /// Frees what [`ShadedStrands::new`] and what the functions behind it made.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.own.into_iter().for_each(|own| own.destroy(backend));
        self.past.into_iter().for_each(|past| past.destroy(backend));
        self.owner.destroy(backend);
    }
}

/// Colours, and what arrives of the light.
fn lit(backend: &mut dyn Backend, shape: StrandShape) -> Result<[BufferId; 2]> {
    let mut each = |label, bytes: u64| {
        let bytes = (bytes * u64::from(shape.strand_vertices())).max(16);
        backend.create_buffer(&BufferDesc::storage(label, bytes))
    };
    Ok([each("hair.render.colors", 8)?, each("hair.render.arriving", 16)?])
}

fn other_strands(found: usize, vertices: usize) -> Error {
    Error::rule("hair.render.own_look", format!("a look for {found} vertices, the guides have {vertices}"))
}

/// A section in a frame.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct SectionDraw<'a> {
    /// Its strands.
    pub strands: &'a ShadedStrands,
    /// Its look.
    pub material: &'a Material,
    /// From the positions in its buffers to the world: `HairSim::pose`, or what takes [`StrandBuffers::center`] to its place.
    pub pose: Pose,
    /// What of it is drawn.
    pub lod: Lod,
}

impl<'a> SectionDraw<'a> {
    /// A section in its place.
    pub fn new(strands: &'a ShadedStrands, material: &'a Material, pose: Pose) -> Self {
        Self { strands, material, pose, lod: Lod::FULL }
    }

    /// The same with less detail.
    #[must_use]
    pub fn lod(self, lod: Lod) -> Self {
        Self { lod, ..self }
    }

    /// The counts of what there is to draw: those of the buffers, with copies ([`Material::copies`]) as more follow strands.
    pub fn drawn_shape(&self) -> StrandShape {
        drawn_shape(self.strands.buffers.shape, self.material.copies)
    }

    /// What strands and copies have of something that the buffers have for each vertex of a strand, in the order of [`SectionDraw::drawn_shape`]: for tools.
    pub fn copied<T: Copy>(&self, values: &[T]) -> Vec<T> {
        let row = self.strands.buffers.shape.strands().max(1) as usize;
        values.chunks(row).flat_map(|row| row.repeat(self.material.copies.clamp(1, MAX_COPIES) as usize)).collect()
    }

    /// The same for positions: where the vertices of copies are.
    pub fn copied_positions(&self, positions: &[[f32; 4]]) -> Vec<[f32; 4]> {
        let (row, uniform) = (self.drawn_shape().strands().max(1) as usize, self.uniform());
        let aside = |place: usize| moved_aside(uniform.strands, (place % row) as u32, uniform.copy_spread).as_vec3();
        let moved = |(place, [x, y, z, w]): (usize, [f32; 4])| (Vec3::new(x, y, z) + aside(place)).extend(w).to_array();
        self.copied(positions).into_iter().enumerate().map(moved).collect()
    }

    /// A point and a distance from it within which what is drawn is in its rest pose, relative to the centre of the buffers.
    pub(crate) fn sphere(&self) -> (Vec3, f32) {
        let (middle, radius) = self.strands.sphere;
        (middle, radius + self.farthest_copy())
    }

    /// How far a copy may be from its strand, in the unit of the positions.
    pub(crate) fn farthest_copy(&self) -> f32 {
        let has_any = self.material.copies > 1;
        if has_any { 3.0_f32.sqrt() * self.material.copy_spread / self.strands.info.metres_per_unit } else { 0.0 }
    }

    pub(crate) fn lod_uniform(&self) -> LodUniform {
        self.lod.uniform(self.drawn_shape())
    }

    /// Strands that are counted for shadows.
    pub(crate) fn shadow_strands(&self) -> u32 {
        self.lod.shadow_strands(self.drawn_shape())
    }

    /// A thread for each vertex that is shaded, a plane for each vertex of a strand: copies have the colours of their strands.
    pub(crate) fn shaded_grid(&self) -> Grid {
        let lod = self.lod_uniform();
        Grid::for_threads(lod.strands.min(self.strands.buffers.shape.strands()), GROUP).planes(lod.vertices)
    }

    /// Vertices that are drawn.
    pub fn vertices(&self) -> u32 {
        let lod = self.lod_uniform();
        lod.strands * lod.vertices
    }

    /// Segments that are drawn.
    pub fn segments(&self) -> u32 {
        let lod = self.lod_uniform();
        lod.strands * (lod.vertices - 1)
    }

    /// Strands that a frame reads, the first ones: those that are drawn and those that shadows count. For strands that are made each frame.
    pub fn needed_strands(&self) -> u32 {
        self.lod_uniform().strands.max(self.shadow_strands()).min(self.strands.buffers.shape.strands())
    }

    /// What the shaders are given.
    pub fn uniform(&self) -> SectionUniform {
        let strands = self.strands;
        let uniform = SectionUniform::new(strands.buffers.shape, &strands.info, self.material, &self.pose, &self.lod);
        let Some(own) = &strands.own else { return uniform };
        uniform.with_own_look(self.material, own.has_color(), own.thickness.is_some())
    }

    /// Uploads what every pass over the section is given.
    pub(crate) fn upload(&self, list: &mut PassList) {
        list.upload(self.strands.uniform, 0, &[self.uniform()]);
        self.strands.own.iter().for_each(|own| own.upload(list, self.material));
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.strands.buffers.shape.segments() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_come_from_all_parts_of_strands() {
        // As many segments a strand as there are segments between two samples.
        let (strands, parts) = (MAX_SAMPLES, 31);
        let mut taken = [0; 31];
        (0..MAX_SAMPLES).for_each(|i| taken[sampled(i, MAX_SAMPLES, strands * parts) % parts] += 1);
        let even = MAX_SAMPLES as u32 / parts as u32;
        assert!(taken.iter().all(|&count: &u32| count.abs_diff(even) <= even / 10), "{taken:?}");
        assert!((0..5).all(|i| sampled(i, 5, 5) == i), "all of them where there are few");
    }
}
