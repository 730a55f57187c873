//! Groups of passes under the name of whose they are, in profilers.

use std::sync::Arc;

/// The group that is open in an encoder.
#[derive(Debug, Default)]
pub(crate) struct Groups<'a>(Option<&'a Arc<str>>);

impl<'a> Groups<'a> {
    /// Before a pass: passes of the same scope share a group.
    pub(crate) fn enter(&mut self, encoder: &mut wgpu::CommandEncoder, scope: Option<&'a Arc<str>>) {
        if self.0 == scope {
            return;
        }
        if self.0.is_some() {
            encoder.pop_debug_group();
        }
        if let Some(scope) = scope {
            encoder.push_debug_group(scope);
        }
        self.0 = scope;
    }
}
