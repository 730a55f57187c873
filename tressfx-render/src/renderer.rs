//! The renderer: it writes the passes that draw hair in a frame.

use tressfx_core::backend::{Backend, Format, Owner};
use tressfx_core::error::{Error, Result};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shader::Binding;
use tressfx_core::view::View;

use crate::counters::Counters;
use crate::draw_error::{DrawError, check_lights};
use crate::lights::Lights;
use crate::output::Output;
use crate::shade::Shade;
use crate::shadow::{ShadowDesc, Shadows};
use crate::strands::SectionDraw;
use crate::technique::{Technique, TechniqueInstance};
use crate::views::{MAX_VIEWS, ViewDraw, Views};

/// The pool is made this many times as large as predicted or measured, since the next frame may need more.
pub(crate) const HEADROOM: f64 = 1.25;

/// What a pool is made for that has to hold this much.
pub(crate) fn with_headroom(wanted: u64) -> u64 {
    (wanted as f64 * HEADROOM) as u64
}

/// Describes a renderer that is to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RenderDesc {
    /// Width and height in pixels of the largest view.
    pub size: [u32; 2],
    /// Format of the colour targets.
    pub target: Format,
    /// How fragments of hair behind each other are sorted and blended.
    pub technique: Technique,
    /// Whether depth and coverage of the hair are written too: see [`Targets::hair`].
    pub hair_output: bool,
    /// How shadows are made; none lights every strand as if it were alone.
    pub shadows: Option<ShadowDesc>,
}

impl RenderDesc {
    /// The default technique, lists of fragments for each pixel, and shadows.
    pub fn new(size: [u32; 2], target: Format) -> Self {
        let shadows = Some(ShadowDesc::default());
        Self { size, target, technique: Technique::default(), hair_output: false, shadows }
    }

    /// The same with other shadows, or with none.
    #[must_use]
    pub fn shadows(self, shadows: impl Into<Option<ShadowDesc>>) -> Self {
        Self { shadows: shadows.into(), ..self }
    }

    /// The same with another technique.
    #[must_use]
    pub fn technique(self, technique: impl Into<Technique>) -> Self {
        Self { technique: technique.into(), ..self }
    }

    /// The same with or without depth and coverage of the hair, which take 4 more bytes a pixel, and 4 more where lists are bounded.
    #[must_use]
    pub fn hair_output(self, hair_output: bool) -> Self {
        Self { hair_output, ..self }
    }

    fn output(&self) -> Output {
        Output { color: self.target, hair: self.hair_output }
    }
}

/// The textures that hair is drawn to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Targets {
    /// The picture so far; hair is blended over it.
    pub color: TextureId,
    /// Depth of the opaque scene, [`Format::Depth32F`], in the order of the view. Hair is tested against it and does not
    /// write it.
    pub depth: TextureId,
    /// Depth and coverage of the hair, [`HAIR_FORMAT`](crate::HAIR_FORMAT), of the same size; where
    /// [`RenderDesc::hair_output`] is set, and only there.
    ///
    /// Red is depth as the opaque scene has it, in the order of the view: that of the nearest fragment of the pixel with an alpha
    /// of at least 0.02, or of the nearest one where all are fainter. Green is `1 - transmittance`, the alpha with which hair is blended
    /// over the picture. Pixels without hair keep what they have, so the caller clears them.
    pub hair: Option<TextureId>,
}

impl Targets {
    /// Two textures of one size.
    pub fn new(color: TextureId, depth: TextureId) -> Self {
        Self { color, depth, hair: None }
    }

    /// The same with a texture for depth and coverage of the hair.
    #[must_use]
    pub fn hair(self, hair: TextureId) -> Self {
        Self { hair: Some(hair), ..self }
    }
}

/// Draws hair: strands are shaded for a view and turned into fragments, which a [`Technique`] sorts and blends.
///
/// The same strands and view give exactly the same picture, bit for bit, as long as all that is to be kept finds room. What does not
/// find room, before the renderer has measured how much there is, depends on the GPU.
#[derive(Debug)]
pub struct HairRenderer {
    desc: RenderDesc,
    views: Views,
    shadows: Option<Shadows>,
    /// The light in which shadows were cast for the frame that is drawn next, and whether there is any.
    cast: Option<(Lights, bool)>,
    shade: Shade,
    order: Box<dyn TechniqueInstance>,
    /// Frees everything above.
    owner: Owner,
}

impl HairRenderer {
    /// Compiles the kernels and makes the buffers whose size depends on that of the view.
    ///
    /// # Errors
    /// A `k` that the technique does not take, a setting of shadows out of its range, what the device lacks, or what the backend says.
    pub fn new(backend: &mut dyn Backend, desc: &RenderDesc) -> Result<Self> {
        let ((order, views, shadows, shade), owner) = Owner::build(backend, |backend| {
            let order = desc.technique.make(backend, desc.size, desc.output())?;
            let shadows = desc.shadows.map(|desc| Shadows::new(backend, &desc)).transpose()?;
            let shade = Shade::new(backend, shadows.is_some())?;
            Ok::<_, Error>((order, Views::new(backend)?, shadows, shade))
        })?;
        Ok(Self { desc: *desc, views, shadows, cast: None, shade, order, owner })
    }

    /// What it was made from.
    pub fn desc(&self) -> &RenderDesc {
        &self.desc
    }

    /// Changes settings of the technique between frames: `k`, `tail` and `cap` of lists, `closed_below` of tiles. A kernel that was not
    /// used before is compiled, and kept. Lists that were written before stay valid.
    ///
    /// # Errors
    /// Another technique, another value of what is not named above, a `k` out of its range, or what the backend says. The
    /// renderer is unchanged then.
    pub fn retune(&mut self, backend: &mut dyn Backend, technique: impl Into<Technique>) -> Result<()> {
        let technique = technique.into();
        self.owner.change(backend, |backend| self.order.retune(backend, &technique))?;
        self.desc.technique = technique;
        Ok(())
    }

    /// Bytes of the buffers in which the technique keeps fragments and pixels at present.
    pub fn technique_bytes(&self) -> u64 {
        self.order.bytes()
    }

    /// Bytes of the buffers in which shadows are made.
    pub fn shadow_bytes(&self) -> u64 {
        self.shadows.as_ref().map_or(0, Shadows::bytes)
    }

    /// Whether tiles draw the next frame: [`Technique::Auto`] may choose them, and lists again.
    pub fn uses_tiles(&self) -> bool {
        self.order.uses_tiles()
    }

    /// How many fragments the pool can hold at present, or references where the technique has tiles; all that can be counted
    /// where it has none.
    pub fn capacity(&self) -> u32 {
        self.order.capacity()
    }

    /// Makes the buffers whose size depends on that of the view again, for views of at most this size. Lists that were
    /// written before stay valid.
    ///
    /// # Errors
    /// As [`HairRenderer::new`]. If it fails, the renderer is unchanged.
    pub fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        self.owner.change(backend, |backend| self.order.resize(backend, size))?;
        self.desc.size = size;
        Ok(())
    }

    /// Enlarges the pool to what a view is predicted to need. Call it for each view, before the first frame, whenever the camera
    /// jumps, and whenever sections come: tiles draw no more vertices than there is room for.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size; the pool is unchanged then.
    pub fn grow_to_predicted(&mut self, backend: &mut dyn Backend, view: &View, draws: &[SectionDraw]) -> Result<()> {
        if view.is_empty() {
            return Ok(());
        }
        let draws: Vec<SectionDraw> = draws.iter().filter(|draw| !draw.is_empty()).copied().collect();
        let wanted = self.order.predicted(view, &draws);
        self.owner.change(backend, |backend| self.order.reserve(backend, wanted, &draws))
    }

    /// Enlarges the pool to what a view has needed in an earlier frame; nothing happens if it is large enough. `counters`
    /// are those that [`HairRenderer::request_counters`] has brought back. Lists that would need more than their limit hold the
    /// nearest fragments of each pixel from then on, and merge the others, see [`PpllDesc::cap`](crate::PpllDesc::cap).
    ///
    /// What was more than twice as large as needed for 120 frames, of which at least 30 measurements came, is made smaller: a groom
    /// that leaves gives its memory back.
    ///
    /// Returns whether the same frame would now find more room.
    ///
    /// # Errors
    /// As [`HairRenderer::grow_to_predicted`].
    pub fn grow_to_measured(&mut self, backend: &mut dyn Backend, counters: &Counters) -> Result<bool> {
        self.owner.change(backend, |backend| self.order.measured(backend, counters))
    }

    /// Casts the shadows of the next frame before it is drawn, so that the surfaces of the caller can be shaded with what hair leaves of the light:
    /// see [`HairRenderer::shadow_bindings`]. [`HairRenderer::draw`] with the same sections then makes no shadows again for views in this
    /// light. Without this call it makes them itself.
    ///
    /// # Errors
    /// [`DrawError`]; nothing is written then.
    pub fn cast(
        &mut self,
        list: &mut PassList,
        lights: &Lights,
        draws: &[SectionDraw],
    ) -> std::result::Result<(), DrawError> {
        check_lights(lights)?;
        draws.iter().try_for_each(|draw| draw.pose.validate())?;
        let Some(shadows) = &mut self.shadows else { return Ok(()) };
        shadows.begin();
        let draws: Vec<SectionDraw> = draws.iter().filter(|draw| !draw.is_empty()).copied().collect();
        draws.iter().for_each(|draw| list.upload(draw.strands.uniform, 0, &[draw.uniform()]));
        let has_any = shadows.passes(list, 0, lights, &draws)?;
        self.cast = Some((lights.clone(), has_any));
        Ok(())
    }

    /// What a shader binds that imports the module `hair_shadow` of [`SHADOW_MODULES`](crate::SHADOW_MODULES); nothing where the renderer makes no shadows. Right
    /// for passes behind [`HairRenderer::cast`] and before [`HairRenderer::draw`].
    pub fn shadow_bindings(&self) -> Vec<(&'static str, Binding)> {
        self.shadows.iter().flat_map(Shadows::bindings).collect()
    }

    /// Draws all sections into all views; their fragments are sorted together. For an empty section or view no pass is
    /// written.
    ///
    /// # Errors
    /// [`DrawError`]; nothing is written then.
    pub fn draw(
        &mut self,
        list: &mut PassList,
        views: &[ViewDraw],
        draws: &[SectionDraw],
    ) -> std::result::Result<(), DrawError> {
        self.check(views, draws)?;
        let draws: Vec<SectionDraw> = draws.iter().filter(|draw| !draw.is_empty()).copied().collect();
        self.order.check(&draws)?;
        self.order.begin(list, views.len(), &draws);
        self.shade.begin();
        let cast = self.cast.take();
        if cast.is_none() {
            self.shadows.iter_mut().for_each(Shadows::begin);
        }
        if draws.is_empty() || views.iter().all(|draw| draw.view.is_empty()) {
            return Ok(());
        }
        self.views.upload(list, views);
        draws.iter().for_each(|draw| list.upload(draw.strands.uniform, 0, &[draw.uniform()]));
        draws.iter().for_each(|draw| self.shade.upload(list, draw));
        // What arrives does not depend on the eye: views in the same light share it.
        let mut lit = cast.as_ref().map(|(lights, has_any)| (lights, *has_any));
        for (index, seen) in views.iter().enumerate().filter(|(_, seen)| !seen.view.is_empty()) {
            let view = self.views.bound(index, seen.view);
            let is_new = lit.is_none_or(|(lights, _)| lights != seen.lights);
            if let Some(shadows) = self.shadows.as_mut().filter(|_| is_new) {
                lit = Some((seen.lights, shadows.passes(list, 1 + index, seen.lights, &draws)?));
            }
            let is_shadowed = lit.is_some_and(|(_, has_any)| has_any);
            for draw in &draws {
                self.shade.pass(list, &view, draw, is_shadowed)?;
            }
            self.order.draw(list, &view, &seen.targets, &draws)?;
        }
        Ok(())
    }

    fn check(&self, views: &[ViewDraw], draws: &[SectionDraw]) -> std::result::Result<(), DrawError> {
        if views.len() > MAX_VIEWS {
            return Err(DrawError::Views(views.len()));
        }
        for draw in views {
            check_lights(draw.lights)?;
            match (self.desc.hair_output, draw.targets.hair) {
                (true, None) => return Err(DrawError::NoHairTarget),
                (false, Some(_)) => return Err(DrawError::UnusedHairTarget),
                _ => (),
            }
            let (view, renderer) = (draw.view.size(), self.desc.size);
            if !draw.view.is_empty() && (view[0] > renderer[0] || view[1] > renderer[1]) {
                return Err(DrawError::Size { view, renderer });
            }
        }
        draws.iter().try_for_each(|draw| draw.pose.validate())?;
        Ok(())
    }

    /// Reads back the counters of a view, as they are at this place of the list; [`Counters::from_bytes`] decodes them.
    ///
    /// # Panics
    /// If a frame cannot have so many views.
    pub fn request_counters(&self, list: &mut PassList, view: usize) -> Ticket {
        let (buffer, offset) = self.order.counters(view);
        list.read_buffer(buffer, offset, Counters::BYTES)
    }

    /// Frees everything that it made.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.owner.destroy(backend);
    }
}

#[cfg(test)]
mod tests {
    use tressfx_core::null::NullBackend;

    use super::*;
    use crate::ppll::{K_RANGE, Ppll, PpllDesc};
    use crate::segments::Fill;
    use crate::shortcut::{ShortCut, ShortCutDesc};
    use crate::technique::Wanted;
    use crate::tiles::{Tiles, TilesDesc, TilesUniform};
    use crate::uniforms::{
        LensUniform, LightUniform, OpaqueUniform, SectionUniform, ShadowFrameUniform, ShadowUniform, ViewUniform,
    };

    fn shortcut(backend: &mut NullBackend, k: u32, ordered: bool) -> ShortCut {
        let desc = ShortCutDesc::default().k(k).ordered(ordered);
        ShortCut::new(backend, &desc, [64, 64], Format::Rgba16F).unwrap()
    }

    fn tiles(backend: &mut NullBackend) -> Tiles {
        Tiles::new(backend, &TilesDesc::default(), [64, 64], Format::Rgba16F).unwrap()
    }

    #[test]
    fn structs_are_laid_out_as_in_the_wgsl() {
        let mut backend = NullBackend::default();
        let shade = Shade::new(&mut backend, true).unwrap();
        let ppll = Ppll::new(&mut backend, &PpllDesc::default(), [64, 64], Format::Rgba16F).unwrap();
        let shortcut = shortcut(&mut backend, 3, false);
        let [fill, resolve, composite] = ppll.shaders();
        let [depths, colors, shortcut_resolve, _] = shortcut.shaders();
        for shader in [&*shade.kajiya.open.shader, fill, resolve, composite, depths, colors, shortcut_resolve] {
            shader.check_layout::<ViewUniform>().unwrap();
            shader.check_layout::<LensUniform>().unwrap();
            shader.check_layout::<LightUniform>().unwrap();
        }
        for shader in [&*shade.kajiya.open.shader, &shade.fibre.open.shader, fill, depths, colors] {
            shader.check_layout::<SectionUniform>().unwrap();
        }
        for shader in [fill, resolve, depths, shortcut_resolve] {
            shader.check_layout::<Counters>().unwrap();
        }
        for shader in [fill, resolve] {
            shader.check_layout::<crate::ppll::PoolUniform>().unwrap();
        }
        let shadows = Shadows::new(&mut backend, &ShadowDesc::default()).unwrap();
        let [frames @ .., opaque] = shadows.shaders();
        for shader in frames {
            shader.check_layout::<ShadowUniform>().unwrap();
            shader.check_layout::<ShadowFrameUniform>().unwrap();
        }
        opaque.check_layout::<OpaqueUniform>().unwrap();
        let tiles = tiles(&mut backend);
        let [points, depth, bin, alloc, blend, reopen] = tiles.shaders();
        for shader in [points, depth, bin, alloc, blend, reopen] {
            shader.check_layout::<ViewUniform>().unwrap();
            shader.check_layout::<LensUniform>().unwrap();
        }
        points.check_layout::<SectionUniform>().unwrap();
        blend.check_layout::<Counters>().unwrap();
        for shader in [depth, bin, alloc, blend, reopen] {
            shader.check_layout::<TilesUniform>().unwrap();
        }
    }

    #[test]
    fn every_kernel_fits_the_limits_of_webgpu() {
        let mut backend = NullBackend::default();
        let shade = Shade::new(&mut backend, true).unwrap();
        assert!(shade.kajiya.shadowed.unwrap().shader.storage_buffers() == 4);
        let shade = shade.fibre.shadowed.unwrap();
        for k in K_RANGE {
            let desc = PpllDesc { k, ..PpllDesc::default() };
            let ppll = Ppll::new(&mut backend, &desc, [64, 64], Format::Rgba8Srgb).unwrap();
            let [fill, resolve, composite] = ppll.shaders();
            assert_eq!(resolve.features, format!("shaded K={k}"));
            let counts = [&*shade.shader, fill, resolve, composite].map(|shader| shader.storage_buffers());
            assert_eq!(counts.into_iter().max(), Some(6), "{counts:?}: what `check` asks for");
        }
        for (k, ordered) in ShortCutDesc::K_RANGE.flat_map(|k| [(k, false), (k, true)]) {
            let counts = shortcut(&mut backend, k, ordered).shaders().map(|shader| shader.storage_buffers());
            assert_eq!(counts.into_iter().max(), Some(7), "{counts:?}: what `check` asks for");
        }
        let shadows = Shadows::new(&mut backend, &ShadowDesc::default()).unwrap();
        assert!(shadows.shaders().into_iter().all(|shader| shader.storage_buffers() <= 5));
        let counts = tiles(&mut backend).shaders().map(|shader| shader.storage_buffers());
        assert_eq!(counts.into_iter().max(), Some(8), "{counts:?}: what `check` asks for");
        let lists = PpllDesc::default().fill(Fill::Raster);
        let lists = Ppll::new(&mut backend, &lists, [64, 64], Format::Rgba8Srgb).unwrap();
        let layers = ShortCutDesc::default().fill(Fill::Raster);
        let layers = ShortCut::new(&mut backend, &layers, [64, 64], Format::Rgba8Srgb).unwrap();
        for shader in lists.shaders().into_iter().chain(layers.shaders()) {
            assert!(shader.storage_buffers() <= 7, "{shader:?}");
            assert_eq!(shader.writes_in_fragments(), shader.label.ends_with("_raster"), "{shader:?}");
        }
    }

    #[test]
    fn depth_of_hair_takes_no_storage_buffer_of_its_own() {
        let layers = ShortCutDesc::default();
        let techniques: [Technique; 5] = [
            PpllDesc::default().into(),
            PpllDesc::default().cap(8).into(),
            layers.into(),
            layers.ordered(true).into(),
            TilesDesc::default().into(),
        ];
        for technique in techniques {
            let [without, with] = [false, true].map(|hair| {
                let mut backend = NullBackend::default();
                technique.make(&mut backend, [64, 64], Output { color: Format::Rgba16F, hair }).unwrap();
                backend.shaders.iter().map(|shader| (shader.label, shader.storage_buffers())).collect::<Vec<_>>()
            });
            assert_eq!(with, without, "{technique:?}");
        }
    }

    #[test]
    fn a_k_out_of_range_is_an_error_that_says_the_range() {
        let mut backend = NullBackend::default();
        let mut refused = |technique: Technique| {
            let desc = RenderDesc::new([64, 64], Format::Rgba16F).technique(technique);
            HairRenderer::new(&mut backend, &desc).unwrap_err().to_string()
        };
        let said = "hair.render.ppll: k is 33, it must be from 0 to 32";
        assert_eq!(refused(PpllDesc::default().k(33).into()), said);
        for k in [0, 9] {
            let said = format!("hair.render.shortcut: k is {k}, it must be from 1 to 8");
            assert_eq!(refused(ShortCutDesc::default().k(k).into()), said);
        }
    }

    #[test]
    fn a_technique_knows_what_it_takes() {
        let techniques: [Technique; 4] = [
            PpllDesc::default().into(),
            PpllDesc::default().cap(5).into(),
            ShortCutDesc::default().into(),
            ShortCutDesc::default().ordered(true).k(8).into(),
        ];
        for technique in techniques {
            for (size, hair) in [[96, 64], [1, 1], [0, 7]].into_iter().flat_map(|size| [(size, false), (size, true)]) {
                let output = Output { color: Format::Rgba16F, hair };
                let mut backend = NullBackend::default();
                let made = technique.make(&mut backend, size, output).unwrap();
                assert_eq!(made.bytes(), backend.memory().bytes, "{technique:?} at {size:?}");
            }
        }
        let mut backend = NullBackend::default();
        let mut pool = Ppll::new(&mut backend, &PpllDesc::default(), [96, 64], Format::Rgba16F).unwrap();
        pool.reserve(&mut backend, Wanted { kept: 100_000, tiles: 0 }, &[]).unwrap();
        pool.resize(&mut backend, [33, 20]).unwrap();
        pool.reserve(&mut backend, Wanted { kept: 50_000, tiles: 0 }, &[]).unwrap();
        assert_eq!(pool.bytes(), backend.memory().bytes);
    }
}
