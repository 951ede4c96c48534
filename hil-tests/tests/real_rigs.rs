//! `dermatome-hil cases` with rigs of real boards, on a machine that has none.

use std::{fs, path::PathBuf, process::Command};

/// A skin whose simulated board stands for a real one at the other end of a port.
const SIMULATED: &str = concat!("sim:", env!("CARGO_MANIFEST_DIR"), "/../host/tests/data/tiny.toml");

fn rig(name: &str, text: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).unwrap();
    path
}

/// Standard output, standard error, and whether it ended well.
fn cases(rig: &PathBuf, more: &[&str]) -> (String, String, bool) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dermatome-hil"));
    let done = command.arg("cases").arg("--rig").arg(rig).args(more).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (text(done.stdout), text(done.stderr), done.status.success())
}

/// The rig must be refused with these words and no case be run.
fn refused(rig: &PathBuf, more: &[&str], parts: &[&str]) {
    let (out, error, is_fine) = cases(rig, more);
    assert!(!is_fine && out.is_empty(), "{out}{error}");
    assert!(error.starts_with("error: ") && !error.contains("panicked"), "{error}");
    for part in parts {
        assert!(error.contains(part), "no `{part}` in {error}");
    }
}

#[test]
fn a_missing_board_is_a_failure() {
    let missing = rig("missing.toml", "kind = \"board\"\nport = \"/dev/no-such-port\"\n");
    refused(&missing, &[], &["the rig has no board", "/dev/no-such-port"]);
}

#[test]
fn a_missing_probe_is_a_failure() {
    let text = format!("kind = \"board\"\nport = \"{SIMULATED}\"\nprobe = \"no such probe\"\n");
    let words: &[&str] = if cfg!(feature = "probe") {
        &["the rig has no board", "no debug probe"]
    } else {
        &["`probe` is `no such probe`", "--features probe"]
    };
    refused(&rig("no-probe.toml", &text), &[], words);
}

#[test]
fn firmware_without_a_probe_is_refused() {
    let text = format!("kind = \"board\"\nport = \"{SIMULATED}\"\n");
    let path = rig("only-port.toml", &text);
    refused(&path, &["--elf", "other.elf"], &["only-port.toml", "other.elf", "no `probe`"]);
    let path = rig("elf.toml", &format!("{text}elf = \"own.elf\"\n"));
    refused(&path, &[], &["elf.toml", "own.elf", "no `probe`"]);
}

#[test]
fn errors_of_a_rig_file_name_the_field() {
    let path = rig("field.toml", "kind = \"board\"\nport = \"COM1\"\nprobes = \"1\"\n");
    refused(&path, &[], &["field.toml", "unknown field `probes`", "`port`, `probe`, `elf`"]);
    let path = rig("port.toml", "kind = \"board\"\nport = \"tcp:nowhere\"\n");
    refused(&path, &[], &["port.toml", "`port`", "tcp:nowhere"]);
}

#[test]
fn what_a_rig_cannot_do_is_not_run_and_counted_last() {
    let path = rig("capabilities.toml", &format!("kind = \"board\"\nport = \"{SIMULATED}\"\n"));
    let (out, error, is_fine) = cases(&path, &["hung CPU", "log says", "programmed again"]);
    assert!(is_fine, "{out}{error}");
    let lines: Vec<_> = out.lines().collect();
    let not_run: Vec<_> = lines.iter().filter(|line| line.starts_with("not run")).collect();
    assert!(not_run.iter().any(|line| line.ends_with("this rig cannot program it")), "{out}");
    assert!(
        not_run.iter().any(|line| line.ends_with("this rig cannot read its log, start it anew")),
        "{out}"
    );
    assert_eq!(lines.last(), Some(&"0 passed, 0 failed, 3 not run"), "{out}");
}
