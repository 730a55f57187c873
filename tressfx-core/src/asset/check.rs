//! Whether the arrays of an asset fit each other: an asset made by hand gets the same care as one from a file.

use super::{AssetError, AssetProblem, HairAsset};

/// By how much rounding may take a share beyond 1.
const ROUNDING: f32 = 1e-3;

/// What the values of an array may be, beside finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Anything.
    Any,
    /// 0 or more.
    NotNegative,
    /// From 0 to 1, and a little above it, as rounding leaves it.
    Share,
}

impl Values {
    fn hold(self, value: f32) -> bool {
        match self {
            Self::Any => true,
            Self::NotNegative => value >= 0.0,
            Self::Share => (0.0..=1.0 + ROUNDING).contains(&value),
        }
    }

    fn expected(self) -> &'static str {
        match self {
            Self::Any => "a finite number",
            Self::NotNegative => "0 or more",
            Self::Share => "from 0 to 1",
        }
    }

    /// What is wrong with a value, if it is not finite or out of range.
    pub fn problem(self, value: f32) -> Option<AssetProblem> {
        let expected = if value.is_finite() { self.expected() } else { "a finite number" };
        let fits = value.is_finite() && self.hold(value);
        (!fits).then(|| AssetProblem::out_of_range(value, expected))
    }

    /// Looks for a value that is out of range: where it is, and what is wrong with it.
    pub fn find_beyond(self, values: &[f32]) -> Option<(usize, AssetProblem)> {
        values.iter().enumerate().find_map(|(index, &value)| Some((index, self.problem(value)?)))
    }
}

/// What an array has an entry for; finds the strand and the vertex of an entry.
#[derive(Clone, Copy, Debug)]
pub enum Domain<'a> {
    /// One entry per strand.
    Strand,
    /// One entry per vertex; the vertex counts of the strands.
    Vertex(&'a [u32]),
}

impl Domain<'_> {
    /// Looks for a value that is not finite among entries of `width` values each. Gives the index of the value as well.
    pub fn find_not_finite(self, values: &[f32], width: usize) -> Option<(usize, AssetProblem)> {
        let index = values.iter().position(|value| !value.is_finite())?;
        let (strand, vertex) = self.locate(index / width);
        Some((index, AssetProblem::NotFinite { strand, vertex, value: values[index] }))
    }

    fn locate(self, entry: usize) -> (usize, usize) {
        let Self::Vertex(counts) = self else { return (entry, 0) };
        let mut left = entry;
        for (strand, &count) in counts.iter().enumerate() {
            match left.checked_sub(count as usize) {
                Some(rest) => left = rest,
                None => return (strand, left),
            }
        }
        (counts.len(), left)
    }
}

/// Name, values, values per entry, what an entry belongs to, and what it may be.
type FloatArray<'a> = (&'static str, Option<&'a [f32]>, usize, Domain<'a>, Values);

impl HairAsset {
    /// Checks that there is a strand, that no strand is empty, that every array has the length that its kind needs, and
    /// that all values are finite, no inverse mass and no thickness is negative, and transparencies and colours are from 0 to 1.
    ///
    /// [`crate::strands::Strands::new`] checks too, because the fields are public.
    ///
    /// # Errors
    /// The first array or value that does not fit.
    pub fn check(&self) -> Result<(), AssetError> {
        self.check_counts()?;
        for (field, values, width, domain, range) in self.float_arrays() {
            let Some(values) = values else { continue };
            self.check_length(field, domain, values.len() / width)?;
            let beyond = domain.find_not_finite(values, width).or_else(|| range.find_beyond(values));
            if let Some((_, kind)) = beyond {
                return Err(self.error(field, kind));
            }
        }
        if let Some(index) = &self.guide_index {
            self.check_length("guide index", Domain::Strand, index.len())?;
        }
        Ok(())
    }

    fn check_counts(&self) -> Result<(), AssetError> {
        if self.counts.is_empty() {
            return Err(self.error("strands", AssetProblem::out_of_range("0", "at least 1")));
        }
        if let Some(strand) = self.counts.iter().position(|&count| count == 0) {
            return Err(
                self.error(&format!("vertices of strand {strand}"), AssetProblem::out_of_range("0", "at least 1"))
            );
        }
        let stated: u64 = self.counts.iter().map(|&count| u64::from(count)).sum();
        let found = self.points.len() as u64;
        if stated == found {
            return Ok(());
        }
        Err(self.error("vertices of all strands", AssetProblem::Mismatch { stated, found, of: "points are there" }))
    }

    /// All arrays of floats.
    fn float_arrays(&self) -> [FloatArray<'_>; 9] {
        use Values::{Any, NotNegative, Share};
        let vertex = Domain::Vertex(&self.counts);
        [
            ("points", Some(self.points.as_flattened()), 3, vertex, Any),
            ("inverse mass", self.inverse_mass.as_deref(), 1, vertex, NotNegative),
            ("strand UVs", flat(&self.strand_uvs), 2, Domain::Strand, Any),
            ("strand w", self.strand_w.as_deref(), 1, Domain::Strand, Any),
            ("strand thickness", self.strand_thickness.as_deref(), 1, Domain::Strand, NotNegative),
            ("vertex UVs", flat(&self.vertex_uvs), 2, vertex, Any),
            ("vertex thickness", self.vertex_thickness.as_deref(), 1, vertex, NotNegative),
            ("vertex transparency", self.vertex_transparency.as_deref(), 1, vertex, Share),
            ("vertex colours", flat(&self.vertex_colors), 4, vertex, Share),
        ]
    }

    fn check_length(&self, field: &str, domain: Domain<'_>, found: usize) -> Result<(), AssetError> {
        let (needed, of) = match domain {
            Domain::Strand => (self.counts.len(), "strands are there"),
            Domain::Vertex(_) => (self.points.len(), "points are there"),
        };
        if needed == found {
            return Ok(());
        }
        Err(self.error(field, AssetProblem::Mismatch { stated: found as u64, found: needed as u64, of }))
    }

    fn error(&self, field: &str, problem: AssetProblem) -> AssetError {
        AssetError { asset: self.name.clone(), field: field.to_owned(), problem }
    }
}

/// An optional array of entries as one of floats.
fn flat<const N: usize>(array: &Option<Vec<[f32; N]>>) -> Option<&[f32]> {
    array.as_ref().map(|array| array.as_flattened())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::AssetFormat;

    fn asset() -> HairAsset {
        HairAsset::new("f", AssetFormat::Text, vec![[0.0; 3]; 5], vec![2, 3])
    }

    #[test]
    fn each_array_must_fit() {
        asset().check().expect("sound");
        let broken: [(&str, HairAsset); 6] = [
            ("strands", HairAsset { counts: vec![], ..asset() }),
            ("vertices of strand 1", HairAsset { counts: vec![5, 0], ..asset() }),
            ("vertices of all strands", HairAsset { counts: vec![2, 2], ..asset() }),
            ("inverse mass", HairAsset { inverse_mass: Some(vec![1.0; 4]), ..asset() }),
            ("strand UVs", HairAsset { strand_uvs: Some(vec![[0.0; 2]; 5]), ..asset() }),
            ("guide index", HairAsset { guide_index: Some(vec![0]), ..asset() }),
        ];
        for (field, asset) in broken {
            assert_eq!(asset.check().expect_err("broken").field, field);
        }
    }

    #[test]
    fn errors_name_strand_and_vertex() {
        let mut broken = asset();
        broken.points[4][1] = f32::INFINITY;
        assert_eq!(
            broken.check().expect_err("inf").to_string(),
            "f: points: strand 1, vertex 2: inf is not a finite number"
        );
        let broken = HairAsset { inverse_mass: Some(vec![0.0, 1.0, 1.0, 1.0, -1.0]), ..asset() };
        assert!(broken.check().expect_err("negative").to_string().contains("is -1, but must be 0 or more"));
        let broken = HairAsset { vertex_colors: Some(vec![[0.0, 0.5, 255.0, 1.0]; 5]), ..asset() };
        assert_eq!(
            broken.check().expect_err("8 bits").to_string(),
            "f: vertex colours: is 255, but must be from 0 to 1"
        );
        let broken = HairAsset { strand_thickness: Some(vec![0.5, -0.5]), ..asset() };
        assert!(broken.check().expect_err("negative").to_string().contains("strand thickness: is -0.5"));
        let rounded = HairAsset { vertex_transparency: Some(vec![1.0 + 1e-6; 5]), ..asset() };
        rounded.check().expect("rounding");
    }
}
