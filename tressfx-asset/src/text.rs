//! Text `.tfx`: the format of the TressFX porting guide of 2013, and its "version 2.0", which later exporters write.
//!
//! ```text
//! version 2.0                        these keys are of 2.0 alone; each may be absent
//! scale 1.0
//! rotation 0 0 0
//! translation 0 0 0
//! bothEndsImmovable 0
//! maxNumVerticesInStrand 4
//! numFollowHairsPerGuideHair 4
//! maxRadiusAroundGuideHair 1.5
//! numStrands 1
//! is sorted 1                        also is_sorted; may stand on the line before
//! strand 0 numVerts 2 texcoord 0.5 0.25
//! -7.929126, 21.516727, 52.696167    separated by blanks, commas or both
//! -7.999047, 24.712219, 57.104229
//! ```
//!
//! A strand may have any number of vertices from 1. It is known by its place: the number that follows `strand` is not kept.

use std::fmt::Write as _;

use tressfx_core::asset::{AssetFormat, AssetProblem, Domain, HairAsset, Placement};

use crate::tokenizer::{Lines, Place, Words};
use crate::{FileError, FileErrorKind};

/// A header key and what it sets.
const KEYS: [&str; 13] = [
    "version",
    "scale",
    "rotation",
    "translation",
    "bothEndsImmovable",
    "maxNumVerticesInStrand",
    "numFollowHairsPerGuideHair",
    "maxRadiusAroundGuideHair",
    "numStrands",
    "is",
    "is_sorted",
    "isSorted",
    "sorted",
];

/// Whether a text that begins with this word is of this format.
pub(crate) fn is_first_word(word: &[u8]) -> bool {
    KEYS.iter().any(|key| key.as_bytes() == word)
}

/// Reads a text file.
///
/// # Errors
/// Where a word is not what the format has in its place, the strands are not as many as the header says, or a value is not
/// finite.
pub fn read(name: &str, data: &[u8]) -> Result<HairAsset, FileError> {
    let mut reader = Reader {
        name,
        lines: Lines::new(name, data),
        stated: None,
        asset: HairAsset::new(name, AssetFormat::Text, Vec::new(), Vec::new()),
    };
    let mut line = reader.header()?;
    while let Some(words) = line {
        reader.strand(words)?;
        line = reader.lines.next();
    }
    reader.finish()
}

struct Reader<'a> {
    name: &'a str,
    lines: Lines<'a>,
    /// The number of strands that the header states, and where.
    stated: Option<(u32, Place)>,
    asset: HairAsset,
}

impl<'a> Reader<'a> {
    /// Reads up to the first strand; gives its line.
    fn header(&mut self) -> Result<Option<Words<'a>>, FileError> {
        for mut words in self.lines.by_ref() {
            if words.clone().word() == b"strand" {
                return Ok(Some(words));
            }
            while !words.is_empty() {
                let place = words.place();
                let key = words.word();
                header_key(&mut self.asset, &mut self.stated, place, key, &mut words)?;
            }
        }
        Ok(None)
    }

    /// Reads a strand, given its first line.
    fn strand(&mut self, mut words: Words<'_>) -> Result<(), FileError> {
        let strand = self.asset.counts.len();
        words.keyword("strand")?;
        words.u32("strand")?;
        words.keyword("numVerts")?;
        let place = words.place();
        let count = words.u32("numVerts")?;
        if count == 0 {
            return Err(place.error(self.name, "numVerts", AssetProblem::out_of_range(0, "at least 1")));
        }
        self.texcoord(words)?;
        for vertex in 0..count {
            let point = self.point(strand, vertex as usize)?;
            self.asset.points.push(point);
        }
        self.asset.counts.push(count);
        Ok(())
    }

    /// Texture coordinates: all strands have none, two, or three.
    fn texcoord(&mut self, mut words: Words<'_>) -> Result<(), FileError> {
        let place = words.place();
        let strands = self.asset.counts.len();
        if !words.is_empty() {
            words.keyword("texcoord")?;
            let uv = [words.f32("texcoord")?, words.f32("texcoord")?];
            self.asset.strand_uvs.get_or_insert_default().push(uv);
            if !words.is_empty() {
                self.asset.strand_w.get_or_insert_default().push(words.f32("texcoord")?);
            }
            words.end("texcoord")?;
        }
        let fits = |length: Option<usize>| length.is_none_or(|length| length == strands + 1);
        if fits(self.asset.strand_uvs.as_ref().map(Vec::len)) && fits(self.asset.strand_w.as_ref().map(Vec::len)) {
            return Ok(());
        }
        let kind = FileErrorKind::Unexpected {
            found: format!("strand {strands}"),
            expected: "as many texture coordinates as the strands before it have",
        };
        Err(place.error(self.name, "texcoord", kind))
    }

    fn point(&mut self, strand: usize, vertex: usize) -> Result<[f32; 3], FileError> {
        let Some(mut words) = self.lines.next() else {
            let kind = FileErrorKind::Unexpected { found: "end of file".to_owned(), expected: "the next vertex" };
            let field = format!("strand {strand}, vertex {vertex}");
            return Err(self.lines.place().error(self.name, &field, kind));
        };
        let place = words.place();
        let point = words.vector("vertex")?;
        if let Some((_, AssetProblem::NotFinite { value, .. })) = Domain::Strand.find_not_finite(&point, 3) {
            return Err(place.error(self.name, "vertex", AssetProblem::NotFinite { strand, vertex, value }));
        }
        words.end("vertex")?;
        Ok(point)
    }

    fn finish(self) -> Result<HairAsset, FileError> {
        let found = self.asset.counts.len();
        let Some((stated, place)) = self.stated else {
            let kind = FileErrorKind::Unexpected { found: "end of file".to_owned(), expected: "a line \"numStrands\"" };
            return Err(self.lines.place().error(self.name, "numStrands", kind));
        };
        if stated == 0 {
            return Err(place.error(self.name, "numStrands", AssetProblem::out_of_range(0, "at least 1")));
        }
        if stated as usize != found {
            let kind =
                AssetProblem::Mismatch { stated: stated.into(), found: found as u64, of: "strands are in the file" };
            return Err(place.error(self.name, "numStrands", kind));
        }
        Ok(self.asset)
    }
}

/// Takes the value of a header key.
fn header_key(
    asset: &mut HairAsset,
    stated: &mut Option<(u32, Place)>,
    place: Place,
    key: &[u8],
    words: &mut Words<'_>,
) -> Result<(), FileError> {
    match key {
        b"version" => asset.version = Some(words.f32("version")?),
        b"scale" => asset.placement.get_or_insert_default().scale = words.f32("scale")?,
        b"rotation" => asset.placement.get_or_insert_default().rotation = finite_vector(words, "rotation")?,
        b"translation" => asset.placement.get_or_insert_default().translation = finite_vector(words, "translation")?,
        b"bothEndsImmovable" => asset.both_ends_immovable = words.u32("bothEndsImmovable")? != 0,
        b"maxNumVerticesInStrand" => asset.max_vertices = Some(words.u32("maxNumVerticesInStrand")?),
        b"numFollowHairsPerGuideHair" => asset.follow_count = Some(words.u32("numFollowHairsPerGuideHair")?),
        b"maxRadiusAroundGuideHair" => asset.follow_radius = Some(words.f32("maxRadiusAroundGuideHair")?),
        b"numStrands" => {
            let place = words.place();
            *stated = Some((words.u32("numStrands")?, place));
        }
        b"is" => {
            words.keyword("sorted")?;
            asset.sorted = Some(words.u32("is sorted")? != 0);
        }
        b"is_sorted" | b"isSorted" | b"sorted" => asset.sorted = Some(words.u32("is sorted")? != 0),
        _ => return Err(words.unexpected(place, "header", key, "a header key of TressFX text, or a strand")),
    }
    Ok(())
}

fn finite_vector(words: &mut Words<'_>, field: &str) -> Result<[f32; 3], FileError> {
    Ok([words.f32(field)?, words.f32(field)?, words.f32(field)?])
}

/// Writes an asset as text; read again it has the same points, counts, texture coordinates per strand and header, to the
/// bit: numbers are printed with as many digits as it takes to read the same bits. [`crate::dropped_by`] says what the
/// format cannot keep.
///
/// # Errors
/// Where the asset does not pass [`HairAsset::check`].
pub fn to_bytes(asset: &HairAsset) -> Result<Vec<u8>, FileError> {
    asset.check()?;
    let mut out = String::new();
    write_header(&mut out, asset)
        .and_then(|()| write_strands(&mut out, asset))
        .map_err(|_| FileError::new(&asset.name, "text", FileErrorKind::Io(std::io::ErrorKind::OutOfMemory.into())))?;
    Ok(out.into_bytes())
}

fn write_header(out: &mut String, asset: &HairAsset) -> std::fmt::Result {
    let of_version_2 = asset.both_ends_immovable
        || asset.placement.is_some()
        || asset.max_vertices.is_some()
        || asset.follow_count.is_some()
        || asset.follow_radius.is_some();
    let version = if asset.format == AssetFormat::Text { asset.version } else { of_version_2.then_some(2.0) };
    if let Some(version) = version {
        writeln!(out, "version {version:?}")?;
    }
    if let Some(Placement { scale, rotation: [rx, ry, rz], translation: [x, y, z] }) = asset.placement {
        writeln!(out, "scale {scale:?}\nrotation {rx:?} {ry:?} {rz:?}\ntranslation {x:?} {y:?} {z:?}")?;
    }
    if asset.both_ends_immovable {
        writeln!(out, "bothEndsImmovable 1")?;
    }
    if let Some(count) = asset.max_vertices {
        writeln!(out, "maxNumVerticesInStrand {count}")?;
    }
    if let Some(count) = asset.follow_count {
        writeln!(out, "numFollowHairsPerGuideHair {count}")?;
    }
    if let Some(radius) = asset.follow_radius {
        writeln!(out, "maxRadiusAroundGuideHair {radius:?}")?;
    }
    writeln!(out, "numStrands {}", asset.strand_count())?;
    match asset.sorted {
        Some(sorted) => writeln!(out, "is sorted {}", u32::from(sorted)),
        None => Ok(()),
    }
}

fn write_strands(out: &mut String, asset: &HairAsset) -> std::fmt::Result {
    for (strand, range) in asset.ranges().enumerate() {
        write!(out, "strand {strand} numVerts {}", range.len())?;
        if let Some([u, v]) = asset.strand_uvs.as_ref().map(|uvs| uvs[strand]) {
            write!(out, " texcoord {u:?} {v:?}")?;
            if let Some(w) = asset.strand_w.as_ref().map(|w| w[strand]) {
                write!(out, " {w:?}")?;
            }
        }
        out.push('\n');
        for [x, y, z] in &asset.points[range] {
            writeln!(out, "{x:?} {y:?} {z:?}")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: &str = "numStrands 2 is_sorted 1\nstrand 0 numVerts 2 texcoord 0.5 0.25 0.125\n0 0 0\n0 1 -0.0\n\
                       strand 1 numVerts 1 texcoord 1 0 0\n1e-3, 2,3\n";

    fn error(text: &str) -> String {
        read("f", text.as_bytes()).expect_err("not sound").to_string()
    }

    #[test]
    fn spellings_of_the_header_and_line_ends_make_no_difference() {
        let expected = read("f", TWO.as_bytes()).expect("sound");
        assert_eq!((expected.counts.as_slice(), expected.sorted), ([2, 1].as_slice(), Some(true)));
        assert_eq!(expected.strand_w, Some(vec![0.125, 0.0]));
        for other in [TWO.replace(" is_sorted", "\nis sorted"), TWO.replace('\n', "\r\n"), TWO.replace('\n', "\n\n")] {
            assert_eq!(read("f", other.as_bytes()).expect("sound"), expected);
        }
    }

    #[test]
    fn what_is_written_is_read_to_the_bit() {
        let asset = read("f", TWO.as_bytes()).expect("sound");
        let again = read("f", &to_bytes(&asset).expect("sound")).expect("just written");
        assert_eq!(again, asset);
        assert_eq!(again.points[1][2].to_bits(), (-0.0f32).to_bits());
    }

    #[test]
    fn errors_name_line_byte_and_field() {
        assert_eq!(
            error(&TWO.replace("0 1 -0.0", "0 one -0.0")),
            "f: vertex (line 4, byte 77): expected a number, found \"one\""
        );
        assert_eq!(
            error(&TWO.replace("numStrands 2", "numStrands 3")),
            "f: numStrands (line 1, byte 11): is 3, but 2 strands are in the file"
        );
        assert!(error(&TWO.replace("numVerts 1", "numVerts 0")).contains("is 0, but must be at least 1"));
        assert!(error(&TWO.replace("numVerts 1", "numVerts 2")).contains("strand 1, vertex 1"));
        assert!(error(&TWO.replace(" texcoord 1 0 0", "")).contains("texcoord"));
        assert!(error("numStrands 1\nfrizz 4\n").contains("found \"frizz\""));
        assert!(error("scale 2\n").contains("numStrands"));
    }
}
