//! Person: who sits before the board, if anybody does.

use super::super::interrupt;
use anyhow::bail;
use dermatome_link::words::escaped_lines;
use std::{
    io::{self, BufRead, IsTerminal, Write},
    sync::mpsc::{Receiver, RecvTimeoutError, channel},
    thread,
    time::Duration,
};

/// How often to look for Ctrl-C while a person thinks.
const POLL: Duration = Duration::from_millis(20);

/// Who answers questions.
pub(super) enum Person {
    /// Somebody at a terminal: the lines that are typed.
    AtTerminal(Receiver<io::Result<String>>),
    /// Nobody: every question is answered with yes.
    Nobody,
}

impl Person {
    /// Somebody at standard input, or nobody where that was said. Input that is no terminal is an error: its questions
    /// would wait for ever, or be answered by what was meant for another program.
    pub(super) fn at_input(says_yes: bool) -> anyhow::Result<Self> {
        if says_yes {
            return Ok(Self::Nobody);
        }
        if !io::stdin().is_terminal() {
            bail!(
                "standard input is no terminal, so that nobody can answer; allowed: a terminal, or `--yes`, which answers every \
                 question with yes"
            );
        }
        let (sender, lines) = channel();
        // Ends with the process: a read from a terminal cannot be given up.
        thread::spawn(move || io::stdin().lock().lines().try_for_each(|line| sender.send(line)));
        Ok(Self::AtTerminal(lines))
    }

    /// Whether nobody is there.
    pub(super) fn is_nobody(&self) -> bool {
        matches!(self, Self::Nobody)
    }

    /// Asks a question; Enter alone is yes, Ctrl-C and the end of the input are no.
    pub(super) fn says_yes(&self, question: &str) -> anyhow::Result<bool> {
        let Self::AtTerminal(lines) = self else { return Ok(true) };
        loop {
            ask(&format!("{question} [Y/n] "))?;
            let Some(answer) = next(lines)? else { return Ok(false) };
            match answer.trim().to_lowercase().as_str() {
                "" | "y" | "yes" => return Ok(true),
                "n" | "no" => return Ok(false),
                other => say!("`{other}` is no answer; allowed: y, n, or Enter for yes"),
            }
        }
    }
}

fn ask(question: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    // Names in it that others gave are only words.
    out.write_all(escaped_lines(question).as_bytes())?;
    out.flush()
}

/// The next line; none where Ctrl-C or the end of the input comes first.
fn next(lines: &Receiver<io::Result<String>>) -> io::Result<Option<String>> {
    while !interrupt::requested() {
        match lines.recv_timeout(POLL) {
            Ok(line) => return line.map(Some),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answers(lines: &[&str]) -> Person {
        let (sender, receiver) = channel();
        lines.iter().for_each(|line| sender.send(Ok((*line).to_owned())).unwrap());
        Person::AtTerminal(receiver)
    }

    #[test]
    fn enter_is_yes_and_what_is_no_answer_is_asked_again() {
        for (lines, expected) in [(["", ""], true), (["no", ""], false), (["perhaps", "Y"], true)] {
            assert_eq!(answers(&lines).says_yes("well?").unwrap(), expected, "{lines:?}");
        }
        assert!(!answers(&[]).says_yes("well?").unwrap(), "the input has ended");
        assert!(Person::Nobody.says_yes("well?").unwrap());
    }
}
