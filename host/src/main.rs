//! The `dermatome` command; all of it lives in the library, see [`dermatome::cli`].

fn main() -> std::process::ExitCode {
    dermatome::cli::main()
}
