//! Tasks: each joins drivers to the shared code, and runs for ever.

pub(crate) mod link;
