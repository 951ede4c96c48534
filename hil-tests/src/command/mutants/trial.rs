//! Trial: the cases in a process of their own, so that a firmware that takes the emulator along, or goes on for ever,
//! ends nothing but its trial.

use dermatome_hil::cases::Case;
use std::{
    error::Error,
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, ChildStdout, Command, Stdio},
    sync::mpsc::{Receiver, RecvTimeoutError, channel},
    thread,
    time::{Duration, Instant},
};

/// Longest that the cases of a trial may take together.
const LONGEST: Duration = Duration::from_secs(900);

/// What became of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// All cases passed.
    Passed,
    /// A case failed: its name, and why.
    Failed(String),
}

/// Runs these cases with the firmware of an ELF until one fails.
pub(super) fn run(rig: &Path, elf: &Path, cases: &[Case]) -> Result<Verdict, Box<dyn Error>> {
    if cases.is_empty() {
        return Ok(Verdict::Passed);
    }
    let mut child = Command::new(std::env::current_exe()?)
        .arg("cases")
        .args([Path::new("--rig"), rig, Path::new("--elf"), elf])
        .args(cases.iter().map(|case| case.name))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    let verdict = child.stdout.take().map(|out| watch(&lines_of(out)));
    let status = end(&mut child, !matches!(verdict, Some(Some(Verdict::Passed))))?;
    match verdict.flatten() {
        Some(Verdict::Passed) if !status => Err("the cases did not run to their end".into()),
        Some(verdict) => Ok(verdict),
        None => Ok(Verdict::Failed(format!("no end after {} s", LONGEST.as_secs()))),
    }
}

/// Waits for the end or the first failure; none if neither comes in time.
fn watch(lines: &Receiver<String>) -> Option<Verdict> {
    let deadline = Instant::now() + LONGEST;
    loop {
        match lines.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(line) => {
                if let Some(failure) = line.strip_prefix("FAILED ") {
                    return Some(Verdict::Failed(failure.trim().to_owned()));
                }
            }
            Err(RecvTimeoutError::Disconnected) => return Some(Verdict::Passed),
            Err(RecvTimeoutError::Timeout) => return None,
        }
    }
}

fn lines_of(out: ChildStdout) -> Receiver<String> {
    let (send, receive) = channel();
    thread::spawn(move || {
        for line in BufReader::new(out).lines().map_while(Result::ok) {
            if send.send(line).is_err() {
                return;
            }
        }
    });
    receive
}

/// Waits for the process, which is ended first where nobody needs the rest; says whether it did well.
fn end(child: &mut Child, early: bool) -> Result<bool, Box<dyn Error>> {
    if early {
        child.kill()?;
    }
    Ok(child.wait()?.success())
}
