//! Shaders that this process has composed and validated already.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use super::{Shader, ShaderSource, Specialization};
use crate::error::Result;

/// Shaders that are kept: more than the library has kernels, and few enough that an application whose constants differ
/// from groom to groom does not fill the memory.
const CAPACITY: usize = 64;

/// The newest first.
static CACHE: Mutex<VecDeque<(ShaderSource, Shader)>> = Mutex::new(VecDeque::new());

/// The shader as it was made before, or else made now and kept. Errors are not kept.
pub(super) fn get_or_make(
    source: &ShaderSource,
    specialization: &Specialization,
    make: impl FnOnce() -> Result<Shader>,
) -> Result<Shader> {
    if let Some(shader) = find(source, specialization) {
        return Ok(shader);
    }
    // Not under the lock: other threads make theirs meanwhile.
    let shader = make()?;
    let mut cache = CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    cache.push_front((*source, shader.clone()));
    cache.truncate(CAPACITY);
    Ok(shader)
}

fn find(source: &ShaderSource, specialization: &Specialization) -> Option<Shader> {
    let mut cache = CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    let same = |(other, shader): &(ShaderSource, Shader)| other == source && shader.specialization == *specialization;
    let index = cache.iter().position(same)?;
    let found = cache.remove(index)?;
    let shader = found.1.clone();
    cache.push_front(found);
    Some(shader)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    const SOURCE: ShaderSource = ShaderSource {
        label: "test.cached",
        root: ("kernel", "import package::constants::COUNT;\n@compute @workgroup_size(COUNT) fn kernel() {}"),
        library: &[],
    };

    #[test]
    fn the_same_source_and_specialization_are_compiled_once() {
        let make = |source: &ShaderSource, count| {
            Shader::new(source, &Specialization::new().constant("COUNT", count)).unwrap()
        };
        let first = make(&SOURCE, 4);
        assert!(Arc::ptr_eq(&first.parsed, &make(&SOURCE, 4).parsed));
        let other = make(&SOURCE, 8);
        assert_eq!(other.entry_points[0].workgroup_size, Some([8, 1, 1]));
        let renamed = make(&ShaderSource { label: "test.renamed", ..SOURCE }, 4);
        assert!(renamed.label == "test.renamed" && !Arc::ptr_eq(&first.parsed, &renamed.parsed));
    }

    #[test]
    fn only_so_many_are_kept() {
        for count in 1..2 * CAPACITY as u32 {
            Shader::new(&SOURCE, &Specialization::new().constant("COUNT", count)).unwrap();
        }
        assert!(CACHE.lock().unwrap().len() <= CAPACITY);
    }
}
