//! The `dermatome` command; all of it lives in the library, see [`dermatome::cli`].
#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    dermatome::cli::main()
}
