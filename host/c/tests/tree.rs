//! What a controller links: not the models, not the command line, not the simulator.

use std::{collections::BTreeSet, env, process::Command};

/// Names of the crates that are built for a controller.
fn crates() -> BTreeSet<String> {
    let arguments = [
        "tree",
        "--package",
        "dermatome-c",
        "--edges",
        "normal",
        "--prefix",
        "none",
        "--locked",
        "--offline",
    ];
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or("cargo".into()));
    let tree = cargo.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let lines = String::from_utf8(tree.stdout).unwrap();
    lines.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

#[test]
fn a_controller_builds_four_crates_of_ours_and_no_models_command_line_or_simulator() {
    let crates = crates();
    let ours: Vec<_> = crates.iter().filter(|name| name.starts_with("dermatome")).collect();
    assert_eq!(ours, ["dermatome-c", "dermatome-link", "dermatome-patch", "dermatome-shared"]);
    for name in ["faer", "clap", "nalgebra", "rayon", "tokio", "probe-rs", "cbindgen"] {
        assert!(!crates.contains(name), "{name} among {crates:?}");
    }
    assert!(crates.contains("serialport") && crates.len() < 80, "{} crates: {crates:?}", crates.len());
}
