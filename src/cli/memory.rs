//! `--memory`: how much a scene may take.

use crate::io::{Budget, Limits};
use clap::Args;

/// How much memory a scene may take.
#[derive(Args, Clone, Debug, Default)]
pub(super) struct MemoryArgs {
    /// Memory that the scene and its picture may take, for example 6G or 800M: what needs more is refused before it is
    /// loaded (default: three quarters of the machine's)
    #[arg(long, value_name = "SIZE", allow_hyphen_values = true)]
    memory: Option<Budget>,
}

impl MemoryArgs {
    /// What was given, or what the machine has to give.
    pub fn budget(&self) -> Budget {
        self.memory.clone().unwrap_or_default()
    }

    /// The limits of files with it.
    pub fn limits(&self) -> Limits {
        Limits {
            memory: self.budget(),
            ..Limits::default()
        }
    }
}
