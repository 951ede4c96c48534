//! Hearing: a `dermatome body` that runs, and what it has last said of each skin.

use crate::until;
use serde_json::Value;
use std::{
    collections::HashMap,
    io::{BufRead, BufReader, Read},
    net::TcpListener,
    process::{Child, ChildStdout, Command},
    sync::{Arc, Mutex},
    thread::{self, JoinHandle},
    time::Duration,
};

/// What was said of a skin.
#[derive(Clone, Debug, Default)]
pub(crate) struct Said {
    pub(crate) phase: String,
    pub(crate) text: String,
    pub(crate) finding: String,
    pub(crate) frames: u64,
}

pub(crate) struct Hearing {
    child: Child,
    said: Arc<Mutex<HashMap<String, Said>>>,
    reader: Option<JoinHandle<()>>,
    errors: Option<JoinHandle<String>>,
}

impl Hearing {
    pub(crate) fn start(mut command: Command) -> Self {
        let mut child = command.spawn().unwrap();
        let said = Arc::<Mutex<HashMap<String, Said>>>::default();
        let (out, known) = (child.stdout.take().unwrap(), said.clone());
        let mut err = child.stderr.take().unwrap();
        let errors = thread::spawn(move || {
            let mut text = String::new();
            err.read_to_string(&mut text).unwrap();
            text
        });
        Self { child, said, reader: Some(thread::spawn(move || read(out, &known))), errors: Some(errors) }
    }

    pub(crate) fn said(&self, skin: &str) -> Said {
        self.said.lock().unwrap().get(skin).cloned().unwrap_or_default()
    }

    /// How long it takes until this is so of a skin.
    #[track_caller]
    pub(crate) fn wait(&mut self, skin: &str, limit: Duration, is_so: impl Fn(&Said) -> bool) -> Duration {
        let waited = until(limit, || is_so(&self.said(skin)) || self.child.try_wait().unwrap().is_some());
        if let Some(waited) = waited
            && is_so(&self.said(skin))
        {
            return waited;
        }
        let _ = self.child.kill();
        let errors = self.errors.take().unwrap().join().unwrap();
        panic!("{skin} after {limit:?}: {:?}; {errors}", self.said.lock().unwrap());
    }

    /// Ends it, as Ctrl-C does.
    pub(crate) fn end(mut self) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let status = self.child.wait().unwrap();
        assert!(status.success(), "{}", self.errors.take().unwrap().join().unwrap());
        // What was read has been in order.
        self.reader.take().unwrap().join().unwrap();
    }
}

impl Drop for Hearing {
    fn drop(&mut self) {
        // Both fail only if it has ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Reads lines until they end; checks that nothing stale is among them.
fn read(out: ChildStdout, said: &Mutex<HashMap<String, Said>>) {
    for line in BufReader::new(out).lines().map(Result::unwrap) {
        let line: Value = serde_json::from_str(&line).unwrap();
        let mut said = said.lock().unwrap();
        let skin = said.entry(line["patch"].as_str().unwrap_or_default().to_owned()).or_default();
        if let Some(finding) = line["finding"].as_str() {
            finding.clone_into(&mut skin.finding);
        } else if let Some(phase) = line["state"]["phase"].as_str() {
            phase.clone_into(&mut skin.phase);
            line["state"]["text"].as_str().unwrap().clone_into(&mut skin.text);
        } else {
            assert_eq!(skin.phase, "live", "stale: {line}");
            assert_eq!(line["link"], "palm", "{line}");
            skin.frames += 1;
        }
    }
}

/// A port of this computer that nobody listens at.
pub(crate) fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}
