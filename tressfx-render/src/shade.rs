//! `hair.render.shade`: the colour of each strand vertex, seen from a view.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::{Kernel, Module, Specialization};

use crate::bound::Bound;
use crate::scattering::{FibreTable, Shape};
use crate::shaders::{compute, with_shared};
use crate::strands::SectionDraw;
use crate::views::BoundView;

const LIBRARY: [Module; 19] = with_shared([("scattering", include_str!("../shaders/scattering.wgsl"))]);

/// The kernels of one way to scatter light.
#[derive(Debug)]
pub(crate) struct Kernels {
    /// Where all light arrives.
    pub(crate) open: Kernel,
    /// Where shadows are made.
    pub(crate) shadowed: Option<Kernel>,
}

impl Kernels {
    fn new(backend: &mut dyn Backend, has_shadows: bool, [fibre, own_colors]: [bool; 2]) -> Result<Self> {
        let root = ("shade", include_str!("../shaders/shade.wgsl"));
        let mut kernel = |shadows| {
            let features = [("shadows", shadows), ("fibre", fibre), ("own_colors", own_colors)];
            let none = Specialization::new();
            let specialization = features.into_iter().fold(none, |made, (name, on)| made.feature(name, on));
            compute(backend, "hair.render.shade", root, &LIBRARY, &specialization)
        };
        Ok(Self { open: kernel(false)?, shadowed: has_shadows.then(|| kernel(true)).transpose()? })
    }
}

/// The kernels of strands that bring colours along, or of those that do not.
#[derive(Debug)]
pub(crate) struct Ways {
    /// Kajiya and Kay.
    pub(crate) kajiya: Kernels,
    /// Fibres that scatter as glass.
    pub(crate) fibre: Kernels,
}

impl Ways {
    fn new(backend: &mut dyn Backend, has_shadows: bool, own_colors: bool) -> Result<Self> {
        let mut kernels = |fibre| Kernels::new(backend, has_shadows, [fibre, own_colors]);
        Ok(Self { kajiya: kernels(false)?, fibre: kernels(true)? })
    }
}

/// A table as it is uploaded, and whether a section of this frame needs it.
type MadeTable = (Shape, Vec<[u32; 4]>, bool);

#[derive(Debug)]
pub(crate) struct Shade {
    pub(crate) plain: Ways,
    /// For strands that bring colours along.
    pub(crate) own: Option<Ways>,
    tables: Vec<MadeTable>,
    /// By view, section, and whether it is shadowed and scatters as glass.
    bound: Bound<(usize, BufferId, [bool; 2])>,
}

impl Shade {
    pub(crate) fn new(backend: &mut dyn Backend, has_shadows: bool, own_colors: bool) -> Result<Self> {
        let plain = Ways::new(backend, has_shadows, false)?;
        let own = own_colors.then(|| Ways::new(backend, has_shadows, true)).transpose()?;
        Ok(Self { plain, own, tables: Vec::new(), bound: Bound::new() })
    }

    pub(crate) fn begin(&mut self) {
        self.bound.begin_frame();
        self.tables.retain(|(_, _, is_used)| *is_used);
        self.tables.iter_mut().for_each(|(_, _, is_used)| *is_used = false);
    }

    /// Uploads what the fibres of a section look up. A table is made where the frame before had none like it.
    pub(crate) fn upload(&mut self, list: &mut PassList, draw: &SectionDraw) {
        let Some(shape) = draw.material.fibre_shape() else { return };
        let index = self.tables.iter().position(|(of, _, _)| *of == shape).unwrap_or_else(|| {
            self.tables.push((shape, FibreTable::new(&shape).packed(), true));
            self.tables.len() - 1
        });
        let (_, table, is_used) = &mut self.tables[index];
        *is_used = true;
        list.upload(draw.strands.fibre_table, 0, table);
    }

    /// `is_shadowed`: what arrives at the strands has been found.
    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draw: &SectionDraw,
        is_shadowed: bool,
    ) -> Result<()> {
        let (strands, is_fibre) = (draw.strands, draw.material.fibre.is_some());
        let own_colors = strands.own_colors();
        let ways = self.own.as_ref().filter(|_| own_colors.is_some()).unwrap_or(&self.plain);
        let kernels = if is_fibre { &ways.fibre } else { &ways.kajiya };
        let shadowed = kernels.shadowed.as_ref().filter(|_| is_shadowed);
        let kernel = shadowed.unwrap_or(&kernels.open);
        let key = (view.index, strands.colors, [shadowed.is_some(), is_fibre]);
        let bindings = self.bound.get(key, || {
            let mut resources = vec![
                ("view", view.uniform),
                ("section", strands.uniform.into()),
                ("positions", strands.buffers.positions.into()),
                ("tangents", strands.buffers.tangents.into()),
                ("colors", strands.colors.into()),
            ];
            resources.extend(shadowed.map(|_| ("arriving", strands.arriving.into())));
            resources.extend(is_fibre.then(|| ("fibre_table", strands.fibre_table.into())));
            resources.extend(own_colors.map(|colors| ("own_colors", colors.into())));
            kernel.bind(&resources)
        })?;
        list.compute(kernel, &bindings, draw.shaded_grid());
        Ok(())
    }
}
