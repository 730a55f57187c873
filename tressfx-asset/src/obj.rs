//! Wavefront `.obj` as hair exporters write it: vertices (`v`), and line elements (`l`) that chain them into strands.
//!
//! A line element may hold two vertices or many, in any order in the file; what is connected is one strand. Its root is the
//! end that its elements lead away from; where they contradict each other, the end with the smaller number. Strands are in
//! the order in which the elements first touch them. Everything else in the file (faces, normals, colours, texture
//! coordinates, names) is not hair and is passed over.
//!
//! The crate `tobj`, which [`crate::mesh`] uses, is not used here, because its errors give no place in the file.

use tressfx_core::asset::{AssetFormat, AssetProblem, Domain, HairAsset};

use crate::tokenizer::{Lines, Place, Words};
use crate::{FileError, FileErrorKind};

/// Whether a text that begins with this word is of this format.
pub(crate) fn is_first_word(word: &[u8]) -> bool {
    matches!(word, b"v" | b"vt" | b"vn" | b"vp" | b"l" | b"o" | b"g" | b"s" | b"mtllib" | b"usemtl")
}

/// Reads the strands of an `.obj` file.
///
/// # Errors
/// Where there is no line element, a number is not one, an element names a vertex that is not in the file, a strand branches
/// or is closed, or a value is not finite.
pub fn read(name: &str, data: &[u8]) -> Result<HairAsset, FileError> {
    let mut points = Vec::new();
    let mut edges = Vec::new();
    let mut lines = Lines::new(name, data);
    for mut words in lines.by_ref() {
        match words.word() {
            b"v" => points.push(point(name, words, points.len())?),
            b"l" => line_element(name, words, points.len(), &mut edges)?,
            _ => {}
        }
    }
    if edges.is_empty() {
        let kind = FileErrorKind::Topology("no line element is in the file: it holds no strands");
        return Err(lines.place().error(name, "l", kind));
    }
    let chains = Chains::new(name, points.len(), &edges)?;
    let mut strands = HairAsset::new(name, AssetFormat::Obj, Vec::new(), Vec::new());
    chains.collect(name, &edges, |strand| {
        strands.counts.push(strand.len() as u32);
        strands.points.extend(strand.iter().map(|&vertex| points[vertex as usize]));
    })?;
    Ok(strands)
}

/// The position of a vertex; a weight or a colour behind it is passed over.
fn point(name: &str, mut words: Words<'_>, vertex: usize) -> Result<[f32; 3], FileError> {
    let place = words.place();
    let point = words.vector("v")?;
    match Domain::Strand.find_not_finite(&point, 3) {
        None => Ok(point),
        Some((index, _)) => {
            let field = format!("v {}", vertex + 1);
            Err(place.error(name, &field, AssetProblem::out_of_range(point[index], "a finite number")))
        }
    }
}

/// Two vertices that follow each other in a line element.
struct Edge {
    from: u32,
    to: u32,
    place: Place,
}

fn line_element(name: &str, mut words: Words<'_>, vertices: usize, edges: &mut Vec<Edge>) -> Result<(), FileError> {
    let mut last = None;
    let first = words.place();
    let before = edges.len();
    while !words.is_empty() {
        let place = words.place();
        let to = vertex_index(name, &mut words, vertices)?;
        if let Some(from) = last.replace(to) {
            edges.push(Edge { from, to, place });
        }
    }
    if edges.len() > before {
        return Ok(());
    }
    Err(first.error(name, "l", FileErrorKind::Topology("a line element needs at least two vertices")))
}

/// An index from 1, or from the end where it is negative; a texture coordinate behind a slash is passed over. Vertices
/// stand before the elements that use them.
fn vertex_index(name: &str, words: &mut Words<'_>, vertices: usize) -> Result<u32, FileError> {
    let place = words.place();
    let word = words.word();
    let digits = word.split(|&byte| byte == b'/').next().unwrap_or_default();
    let number = std::str::from_utf8(digits).ok().and_then(|digits| digits.parse::<i64>().ok());
    let Some(number) = number else { return Err(words.unexpected(place, "l", word, "the number of a vertex")) };
    let index = if number < 0 { number.saturating_add(vertices as i64) } else { number - 1 };
    match u32::try_from(index) {
        Ok(index) if (index as usize) < vertices => Ok(index),
        _ => Err(place.error(
            name,
            "l",
            AssetProblem::out_of_range(number, "the number of a vertex that stands before it"),
        )),
    }
}

/// One side of a vertex: the neighbour there, and whether the element leads to it.
#[derive(Clone, Copy)]
struct Link {
    to: u32,
    forward: bool,
}

/// What every vertex is connected to: at most two others.
struct Chains {
    links: Vec<[Option<Link>; 2]>,
}

impl Chains {
    fn new(name: &str, vertices: usize, edges: &[Edge]) -> Result<Self, FileError> {
        let mut chains = Self { links: vec![[None; 2]; vertices] };
        for &Edge { from, to, place } in edges {
            let connected = from != to
                && chains.connect(from, Link { to, forward: true })
                && chains.connect(to, Link { to: from, forward: false });
            if !connected {
                let kind = FileErrorKind::Topology("the strand branches, or returns to its own vertex");
                return Err(place.error(name, "l", kind));
            }
        }
        Ok(chains)
    }

    fn connect(&mut self, vertex: u32, link: Link) -> bool {
        let free = self.links[vertex as usize].iter_mut().find(|side| side.is_none());
        free.map(|side| *side = Some(link)).is_some()
    }

    /// Gives each strand, root first.
    fn collect(&self, name: &str, edges: &[Edge], mut strand: impl FnMut(&[u32])) -> Result<(), FileError> {
        let mut seen = vec![false; self.links.len()];
        for edge in edges.iter() {
            if seen[edge.from as usize] {
                continue;
            }
            let Some(path) = self.path(edge.from) else {
                return Err(edge.place.error(name, "l", FileErrorKind::Topology("the strand is closed")));
            };
            path.iter().for_each(|&vertex| seen[vertex as usize] = true);
            strand(&path);
        }
        Ok(())
    }

    /// The strand through a vertex, root first; `None` where it is closed.
    fn path(&self, start: u32) -> Option<Vec<u32>> {
        let mut path = Vec::new();
        let mut forward = 0i64;
        self.walk(start, 0, |vertex, leads| {
            path.push(vertex);
            forward -= if leads { 1 } else { -1 };
        })?;
        path.reverse();
        path.push(start);
        self.walk(start, 1, |vertex, leads| {
            path.push(vertex);
            forward += if leads { 1 } else { -1 };
        })?;
        if forward < 0 || (forward == 0 && path.last() < path.first()) {
            path.reverse();
        }
        Some(path)
    }

    /// Visits the vertices on one side of a vertex, up to the end; `None` where it comes back.
    fn walk(&self, start: u32, side: usize, mut visit: impl FnMut(u32, bool)) -> Option<()> {
        let (mut at, mut link) = (start, self.links[start as usize][side]);
        while let Some(Link { to, forward }) = link {
            if to == start {
                return None;
            }
            visit(to, forward);
            let [a, b] = self.links[to as usize];
            link = if a.is_some_and(|a| a.to == at) { b } else { a };
            at = to;
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The x coordinates of each strand, for vertices on the x axis.
    fn strands(elements: &str) -> Result<Vec<Vec<f32>>, String> {
        let vertices: String = (1..=6).map(|x| format!("v {x} 0 0\n")).collect();
        let asset = read("f", (vertices + elements).as_bytes()).map_err(|error| error.to_string())?;
        Ok(asset.ranges().map(|range| asset.points[range].iter().map(|point| point[0]).collect()).collect())
    }

    #[test]
    fn elements_are_chained_in_any_order() {
        assert_eq!(strands("l 1 2\nl 2 3\nl 4 5\n"), Ok(vec![vec![1.0, 2.0, 3.0], vec![4.0, 5.0]]));
        assert_eq!(strands("l 2 3\nl 3 4\nl 1 2\n"), Ok(vec![vec![1.0, 2.0, 3.0, 4.0]]));
        assert_eq!(strands("l 1 2 3\n"), Ok(vec![vec![1.0, 2.0, 3.0]]));
    }

    #[test]
    fn the_root_is_where_the_elements_lead_away_from() {
        assert_eq!(strands("l 3 2\nl 2 1\n"), Ok(vec![vec![3.0, 2.0, 1.0]]));
        assert_eq!(strands("l 3/1 2/1 -6/1\n"), Ok(vec![vec![3.0, 2.0, 1.0]]));
        assert_eq!(strands("l 5 4\nl 5 6\n"), Ok(vec![vec![4.0, 5.0, 6.0]]));
    }

    #[test]
    fn what_is_no_strand_is_refused_with_its_line() {
        for (elements, message) in [
            ("l 1 2\nl 1 3\nl 1 4\n", "l (line 9, byte 64): the strand branches"),
            ("l 1 2\nl 2 3\nl 3 1\n", "closed"),
            ("l 1 1\n", "its own vertex"),
            ("l 1\n", "at least two"),
            ("l 1 7\n", "is 7, but must be the number of a vertex"),
            ("l 1 0\n", "is 0, but must be"),
            ("l 1 x\n", "found \"x\""),
            ("", "no line element"),
        ] {
            let error = strands(elements).expect_err("no strands");
            assert!(error.contains(message), "{error}");
        }
    }
}
