//! `.tfxmesh` of TressFX 4: a skinned mesh as text.
//!
//! `numOfBones N` and a line `index name` for each; `numOfVertices N` and a line `index`, position, normal, four bones, four weights for each;
//! `numOfTriangles N` and a line `index` and three vertices for each. Lines that begin with `#` are comments. Everything is in order of its index.

use tressfx_core::asset::AssetProblem;
use tressfx_core::body::{Influences, SkinnedMesh};
use tressfx_core::glam::Vec3;

use crate::FileError;
use crate::tokenizer::{Lines, Words};

const BONES: &str = "numOfBones";
const VERTICES: &str = "numOfVertices";
const TRIANGLES: &str = "numOfTriangles";

/// Whether a text begins as one does.
pub(crate) fn is_first_word(word: &[u8]) -> bool {
    word == BONES.as_bytes()
}

/// Lines that are no comments.
struct Reader<'a> {
    name: &'a str,
    lines: Lines<'a>,
}

impl<'a> Reader<'a> {
    /// The next line; at the end of the file an empty one.
    fn line(&mut self) -> Option<Words<'a>> {
        self.lines.find(|line| !line.clone().word().starts_with(b"#"))
    }

    fn expect(&mut self, field: &str) -> Result<Words<'a>, FileError> {
        let place = self.lines.place();
        let available = 0;
        self.line()
            .ok_or_else(|| place.error(self.name, field, crate::FileErrorKind::Truncated { needed: 1, available }))
    }

    /// A line of a keyword and a count.
    fn count(&mut self, keyword: &'static str) -> Result<u32, FileError> {
        let mut line = self.expect(keyword)?;
        line.keyword(keyword)?;
        let count = line.u32(keyword)?;
        line.end(keyword)?;
        Ok(count)
    }

    /// The next line, behind its index, which must be the one expected.
    fn entry(&mut self, field: &str, index: u32) -> Result<Words<'a>, FileError> {
        let mut line = self.expect(field)?;
        let place = line.place();
        match line.u32(field)? {
            found if found == index => Ok(line),
            found => Err(place.error(self.name, field, AssetProblem::out_of_range(found, "the index that comes next"))),
        }
    }

    /// A number that names one of `count` things.
    fn index(&self, line: &mut Words<'_>, field: &str, count: usize, of: &'static str) -> Result<u32, FileError> {
        let place = line.place();
        match line.number::<i64>(field, "a whole number")? {
            index if (0..count as i64).contains(&index) => Ok(index as u32),
            index => Err(place.error(self.name, field, AssetProblem::out_of_range(index, of))),
        }
    }
}

/// Reads a `.tfxmesh` file.
///
/// # Errors
/// A file that is cut off or out of order, an index that names nothing, a value that is not finite, weights that are negative or all 0. The
/// error names the line and the vertex or triangle.
pub fn read(name: &str, data: &[u8]) -> Result<SkinnedMesh, FileError> {
    let mut reader = Reader { name, lines: Lines::new(name, data) };
    let mut mesh = SkinnedMesh { name: name.to_owned(), ..SkinnedMesh::default() };
    for bone in 0..reader.count(BONES)? {
        let field = format!("bone {bone}");
        let mut line = reader.entry(&field, bone)?;
        mesh.joints.push(String::from_utf8_lossy(line.word()).into_owned());
    }
    for vertex in 0..reader.count(VERTICES)? {
        let field = format!("vertex {vertex}");
        let mut line = reader.entry(&field, vertex)?;
        self::vertex(&reader, &mut line, &field, &mut mesh)?;
        line.end(&field)?;
    }
    let vertices = mesh.positions.len();
    for triangle in 0..reader.count(TRIANGLES)? {
        let field = format!("triangle {triangle}");
        let mut line = reader.entry(&field, triangle)?;
        let mut corner = || reader.index(&mut line, &field, vertices, "a vertex of the file");
        mesh.triangles.push([corner()?, corner()?, corner()?]);
        line.end(&field)?;
    }
    let place = reader.lines.place();
    mesh.check().map_err(|error| place.error(name, "mesh", error))?;
    Ok(mesh)
}

fn vertex(reader: &Reader<'_>, line: &mut Words<'_>, field: &str, mesh: &mut SkinnedMesh) -> Result<(), FileError> {
    let vector =
        |line: &mut Words<'_>| Ok::<_, FileError>(Vec3::new(line.f32(field)?, line.f32(field)?, line.f32(field)?));
    mesh.positions.push(vector(line)?);
    mesh.normals.push(vector(line)?.normalize_or(Vec3::Y));
    let joints = mesh.joints.len();
    let mut joint = || reader.index(line, field, joints, "a bone of the file");
    let joints = [joint()?, joint()?, joint()?, joint()?];
    let place = line.place();
    let weights = [line.f32(field)?, line.f32(field)?, line.f32(field)?, line.f32(field)?];
    let pairs = [0, 1, 2, 3].map(|slot| (joints[slot], weights[slot]));
    let Some(influences) = Influences::strongest(&pairs) else {
        let problem = AssetProblem::out_of_range(format!("{weights:?}"), "weights of 0 or more, not all 0");
        return Err(place.error(reader.name, field, problem));
    };
    mesh.influences.push(influences);
    Ok(())
}
