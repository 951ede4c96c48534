//! The program as a user runs it: real processes, in a folder of their own, with a time limit.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub(crate) mod keeping;

use assert_cmd::cargo::cargo_bin;
use dermatome::{model::Model, skin::Skin};
use serde_json::Value;
use std::{
    fmt::Write as _,
    io::{BufRead, BufReader, Read},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, ExitStatus, Stdio},
    sync::mpsc::channel,
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};
use tempfile::TempDir;

/// Longest any command of these tests may take; a busy machine needs some of it.
pub(crate) const LIMIT: Duration = Duration::from_secs(180);

/// Whether it is also tested how soon all is done: with `DERMATOME_BOUNDS=1`, on a computer without other work.
pub(crate) fn has_bounds() -> bool {
    std::env::var_os("DERMATOME_BOUNDS").is_some()
}

/// How long something may take that is to take `bound` at most.
pub(crate) fn within(bound: Duration) -> Duration {
    if has_bounds() { bound } else { 10 * bound }
}

/// A coarse skin of 8 electrodes.
pub(crate) const TINY: &str = include_str!("../data/tiny.toml");

/// A skin file with a line replaced.
pub(crate) fn with(text: &str, line: &str, other: &str) -> String {
    assert!(text.contains(line), "{line}");
    text.replace(line, other)
}

/// A folder in which commands run, so that their messages hold no path of this machine.
pub(crate) struct Desk {
    folder: TempDir,
}

impl Desk {
    /// An empty folder.
    pub(crate) fn empty() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// A folder with `skin.toml` and the patch of that skin, `skin.dermatome`.
    pub(crate) fn with_patch() -> Self {
        let desk = Self::empty();
        desk.write("skin.toml", TINY);
        desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
        desk
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    pub(crate) fn report(&self, name: &str) -> Value {
        serde_json::from_slice(&self.read(name)).unwrap()
    }

    /// Names of all files, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(cargo_bin("dermatome"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .env("COLUMNS", "100")
            .env("RUST_BACKTRACE", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    /// Runs a command to its end.
    pub(crate) fn run(&self, arguments: &[&str]) -> Done {
        self.start(arguments).finish()
    }

    pub(crate) fn start(&self, arguments: &[&str]) -> Running {
        Running::start(&mut self.command(arguments))
    }

    /// A simulated board of `skin`, and its port.
    pub(crate) fn board(&self, skin: &str, more: &[&str]) -> (Running, String) {
        let mut board = self.start(&[&["simulate", skin, "--listen", "tcp:127.0.0.1:0"], more].concat());
        let line = board.line();
        let (_, port) = line.trim().split_once(" listens at ").unwrap_or_else(|| panic!("{line}"));
        (board, port.to_owned())
    }
}

/// A process that is killed when the test lets go of it, however it does.
pub(crate) struct Running {
    what: String,
    child: Child,
    out: Option<BufReader<std::process::ChildStdout>>,
    /// What reads standard output as it comes.
    reads: Option<JoinHandle<String>>,
    err: Option<JoinHandle<String>>,
}

impl Running {
    pub(crate) fn start(command: &mut Command) -> Self {
        let mut child = command.spawn().unwrap();
        let out = child.stdout.take().map(BufReader::new);
        let err = child.stderr.take().map(collect);
        Self { what: format!("{command:?}"), child, out, reads: None, err }
    }

    /// A process whose standard input is piped, and that input.
    pub(crate) fn with_input(command: &mut Command) -> (Self, ChildStdin) {
        let mut running = Self::start(command.stdin(Stdio::piped()));
        let input = running.child.stdin.take().unwrap();
        (running, input)
    }

    /// The next line of standard output, which must come within [`LIMIT`].
    pub(crate) fn line(&mut self) -> String {
        let mut out = self.out.take().unwrap();
        let (sender, line) = channel();
        thread::spawn(move || {
            let mut line = String::new();
            out.read_line(&mut line).unwrap();
            // Fails if the line has come too late for anyone to wait.
            let _ = sender.send((out, line));
        });
        let line = line.recv_timeout(LIMIT);
        let (out, line) = line.unwrap_or_else(|_| panic!("no line in {LIMIT:?}: {}", self.what));
        assert!(!line.is_empty(), "no further line: {}", self.what);
        self.out = Some(out);
        line
    }

    pub(crate) fn is_running(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    /// Reads standard output from now on as it comes: a pipe holds 64 KiB, and whoever writes more waits.
    pub(crate) fn read_output(&mut self) {
        self.reads = self.out.take().map(collect);
    }

    /// Nobody reads standard output any more.
    pub(crate) fn close_output(&mut self) {
        self.out = None;
    }

    /// Number of the process.
    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// As Ctrl-C does.
    #[cfg(unix)]
    pub(crate) fn interrupt(&self) {
        let id = self.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    }

    /// Waits for the end, at most [`LIMIT`].
    pub(crate) fn finish(self) -> Done {
        self.finish_within(LIMIT)
    }

    pub(crate) fn finish_within(mut self, limit: Duration) -> Done {
        if self.reads.is_none() {
            self.read_output();
        }
        let started = Instant::now();
        let status = loop {
            match self.child.try_wait().unwrap() {
                Some(status) => break status,
                None if started.elapsed() > limit => {
                    // Dropping the process kills it.
                    panic!("still running after {limit:?}: {}", self.what);
                }
                None => thread::sleep(Duration::from_millis(5)),
            }
        };
        let text =
            |thread: Option<JoinHandle<String>>| thread.map_or_else(String::new, |t| t.join().unwrap());
        Done { status, out: text(self.reads.take()), err: text(self.err.take()) }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Both fail only if it has ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Memory of a process that is in use, kB.
#[cfg(target_os = "linux")]
pub(crate) fn memory(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().split(' ').next().unwrap().parse().unwrap()
}

/// A number that the environment may say.
pub(crate) fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().unwrap())
}

fn collect(mut stream: impl Read + Send + 'static) -> JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    })
}

/// What a command said and how it ended.
#[derive(Debug)]
pub(crate) struct Done {
    pub(crate) status: ExitStatus,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Done {
    /// The command must have succeeded.
    #[track_caller]
    pub(crate) fn success(self) -> Self {
        assert!(self.status.success(), "{self:#?}");
        self
    }

    /// The command must have refused, in words: no panic, no backtrace, nothing but its error.
    #[track_caller]
    pub(crate) fn refused(self) -> String {
        let Self { status, err, .. } = &self;
        assert!(matches!(status.code(), Some(1 | 2)), "{self:#?}");
        assert!(err.starts_with("error: ") || err.contains("\nerror: "), "{self:#?}");
        assert!(!err.contains("panicked") && !err.to_lowercase().contains("backtrace"), "{self:#?}");
        self.err
    }
}

/// Runs each command, which must be refused, and gives a transcript.
pub(crate) fn transcript(desk: &Desk, commands: &[&[&str]]) -> String {
    let refused = |arguments: &&[&str]| {
        let words = desk.run(arguments).refused();
        format!("$ dermatome {}\n{}\n", arguments.join(" "), words.trim_end())
    };
    commands.iter().map(refused).collect::<Vec<_>>().join("\n")
}

/// Every key of a report with the type of its value, one line each; entries of a list share a line.
pub(crate) fn shape(report: &Value) -> String {
    let mut lines = Vec::new();
    add_shape("", report, &mut lines);
    lines.dedup();
    let mut text = String::new();
    let mut seen = std::collections::HashSet::new();
    for line in lines.into_iter().filter(|line| seen.insert(line.clone())) {
        writeln!(text, "{line}").unwrap();
    }
    text
}

fn add_shape(at: &str, value: &Value, lines: &mut Vec<String>) {
    let kind = match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let dot = if at.is_empty() { "" } else { "." };
                add_shape(&format!("{at}{dot}{key}"), value, lines);
            }
            return;
        }
        Value::Array(entries) if !entries.is_empty() => {
            for entry in entries {
                add_shape(&format!("{at}[]"), entry, lines);
            }
            return;
        }
        Value::Array(_) => "empty list",
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(number) if number.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "text",
    };
    lines.push(format!("{at}: {kind}"));
}

/// What a perfect instrument would read on the untouched tiny skin: `[step]`.
pub(crate) fn tiny_voltages() -> Vec<f64> {
    let skin = Skin::parse(Path::new("skin.toml"), TINY).unwrap().made().unwrap();
    Model::build(&skin, |_| ()).unwrap().voltages
}

/// A row of a table of frames.
pub(crate) fn row(values: &[f64]) -> String {
    let cells: Vec<_> = values.iter().map(|value| format!("{value:.9e}")).collect();
    cells.join(",") + "\n"
}
