//! The `dermatome` command; all of it lives in the crate `dermatome-command`.
#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    dermatome_command::main()
}
