//! Trial: the cases in a process of their own, so that a firmware that takes the emulator along, or goes on for ever,
//! ends nothing but its trial.

use dermatome_hil::cases::Case;
use std::{
    error::Error,
    io::{BufRead, BufReader, Read},
    path::Path,
    process::{Command, Stdio},
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
        .stderr(Stdio::piped())
        .spawn()?;
    let (Some(out), Some(errors)) = (child.stdout.take(), child.stderr.take()) else {
        return Err("the cases have no output".into());
    };
    let (lines, errors) = (lines_of(out), lines_of(errors));
    let verdict = watch(&lines);
    if verdict != Some(Verdict::Passed) {
        // Nobody needs the rest.
        child.kill()?;
    }
    let is_fine = child.wait()?.success();
    Ok(match verdict {
        Some(Verdict::Passed) if !is_fine => Verdict::Failed(last_words(&errors)),
        Some(verdict) => verdict,
        None => Verdict::Failed(format!("no end after {} s", LONGEST.as_secs())),
    })
}

/// What a process that did not come to its end said: the reason of the first panic, or its error.
fn last_words(errors: &Receiver<String>) -> String {
    let mut lines = errors.iter();
    let says = |line: &String| line.contains("panicked at") || line.starts_with("error: ");
    let found = lines.find(says).unwrap_or_else(|| "it says nothing".to_owned());
    let reason = if found.starts_with("error: ") { None } else { lines.next() };
    format!("the cases ended early: {}", reason.unwrap_or(found))
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

fn lines_of(out: impl Read + Send + 'static) -> Receiver<String> {
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
