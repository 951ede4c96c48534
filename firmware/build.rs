//! Hands the linker its scripts, so that any cargo links this crate without further settings.

use std::{env, error::Error, fs, path::PathBuf};

/// Each is a feature, a module of `board` and a file in `memory`.
const BOARDS: [&str; 2] = ["nucleo-g474re", "nucleo-l496zg"];

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(env::var("OUT_DIR")?);
    println!("cargo::rustc-link-search={}", out.display());
    // With none or several, `board` says what is wrong.
    if let [board] = chosen_boards()[..] {
        let memory = format!("memory/{board}.x");
        fs::copy(&memory, out.join("memory.x"))?;
        println!("cargo::rerun-if-changed={memory}");
    }
    // Without --nmagic the linker aligns segments to pages, and the flash image grows a gap.
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    Ok(())
}

fn chosen_boards() -> Vec<&'static str> {
    let is_chosen = |board: &&str| {
        let name = board.to_uppercase().replace('-', "_");
        env::var_os(format!("CARGO_FEATURE_{name}")).is_some()
    };
    BOARDS.into_iter().filter(is_chosen).collect()
}
