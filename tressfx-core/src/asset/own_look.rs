//! Colours and widths that an asset stands for.

use std::borrow::Cow;

use super::HairAsset;

impl HairAsset {
    /// Colour and opacity per vertex, RGBA as the file has them: its colours, or the default colour of its header, or else white; transparency is taken off
    /// the opacity. `None` where the file says nothing of either.
    ///
    /// A header whose default colour is black or white, or any other of zeros and ones alone, says nothing: that is what programs leave there.
    pub fn colors(&self) -> Option<Cow<'_, [[f32; 4]]>> {
        let transparency = self.transparency();
        let default = self.hair_defaults.as_ref().map(|defaults| defaults.color);
        let default = default.filter(|color| color.iter().any(|&part| part > 0.0 && part < 1.0));
        let colors: Cow<[[f32; 4]]> = match (&self.vertex_colors, default, &transparency) {
            (Some(colors), _, _) => colors.as_slice().into(),
            (None, Some([r, g, b]), _) => vec![[r, g, b, 1.0]; self.points.len()].into(),
            (None, None, Some(_)) => vec![[1.0; 4]; self.points.len()].into(),
            (None, None, None) => return None,
        };
        let Some(transparency) = transparency else { return Some(colors) };
        let mut colors = colors.into_owned();
        colors.iter_mut().zip(transparency.iter()).for_each(|(color, share)| color[3] *= (1.0 - share).max(0.0));
        Some(colors.into())
    }

    /// Transparency per vertex, where any is not opaque by the header.
    fn transparency(&self) -> Option<Cow<'_, [f32]>> {
        if let Some(transparency) = &self.vertex_transparency {
            return Some(transparency.as_slice().into());
        }
        let default = self.hair_defaults.as_ref().map(|defaults| defaults.transparency);
        default.filter(|&share| share > 0.0).map(|share| vec![share; self.points.len()].into())
    }

    /// Thickness per vertex: the file's, or that of its strands. `None` where the file has neither; the one number of a header tells no vertex from another.
    pub fn widths(&self) -> Option<Cow<'_, [f32]>> {
        if let Some(thickness) = &self.vertex_thickness {
            return Some(thickness.as_slice().into());
        }
        let of_strands = self.strand_thickness.as_ref()?.iter().zip(&self.counts);
        Some(of_strands.flat_map(|(&width, &count)| std::iter::repeat_n(width, count as usize)).collect())
    }

    /// Thickness per strand: the file's, or that of the vertices where those of each strand are alike.
    pub fn strand_widths(&self) -> Option<Cow<'_, [f32]>> {
        let Some(thickness) = &self.vertex_thickness else { return self.strand_thickness.as_deref().map(Cow::from) };
        let alike = |strand: &[f32]| {
            let (&first, rest) = strand.split_first()?;
            rest.iter().all(|&width| width == first).then_some(first)
        };
        let widths: Option<Vec<f32>> = self.ranges().map(|range| alike(thickness.get(range)?)).collect();
        widths.map(Cow::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::{AssetFormat, HairDefaults};

    fn asset() -> HairAsset {
        HairAsset::new("f", AssetFormat::Hair, vec![[0.0; 3]; 3], vec![1, 2])
    }

    fn header(color: [f32; 3], transparency: f32) -> Option<HairDefaults> {
        Some(HairDefaults { segments: 0, thickness: 0.1, transparency, color, info: [0; 88] })
    }

    #[test]
    fn colours_are_those_of_the_vertices_or_of_the_header() {
        assert_eq!(asset().colors(), None);
        let said = HairAsset { hair_defaults: header([0.5, 0.2, 0.1], 0.25), ..asset() };
        assert_eq!(said.colors().expect("from the header").to_vec(), [[0.5, 0.2, 0.1, 0.75]; 3]);
        for nothing in [[0.0; 3], [1.0; 3]] {
            assert_eq!(HairAsset { hair_defaults: header(nothing, 0.0), ..asset() }.colors(), None);
        }
        let own = [[0.1, 0.2, 0.3, 1.0], [0.4, 0.5, 0.6, 1.0], [0.7, 0.8, 0.9, 0.5]];
        let both = HairAsset {
            vertex_colors: Some(own.to_vec()),
            vertex_transparency: Some(vec![0.0, 0.5, 1.0]),
            ..said.clone()
        };
        let colors = both.colors().expect("they are there").to_vec();
        assert_eq!(colors.iter().map(|color| color[3]).collect::<Vec<_>>(), [1.0, 0.5, 0.0]);
        assert_eq!(colors[1][..3], own[1][..3]);
    }

    #[test]
    fn widths_of_strands_and_of_vertices_stand_for_each_other() {
        assert!(asset().widths().is_none() && asset().strand_widths().is_none());
        let strands = HairAsset { strand_thickness: Some(vec![2.0, 3.0]), ..asset() };
        assert_eq!(strands.widths().expect("spread").to_vec(), [2.0, 3.0, 3.0]);
        let vertices = |widths| HairAsset { vertex_thickness: Some(widths), ..asset() };
        assert_eq!(vertices(vec![2.0, 3.0, 3.0]).strand_widths().expect("alike").to_vec(), [2.0, 3.0]);
        assert_eq!(vertices(vec![2.0, 3.0, 1.0]).strand_widths(), None);
    }
}
