//! Lines: frames for whoever reads standard output, who may stall.
//!
//! A thread of its own writes them, so that the board is listened to meanwhile and what comes is new: a frame that has
//! waited for longer than [`MOST_AGE`] is dropped and counted, and a line says so where it would have been. What the
//! system's pipe has taken cannot be taken back.

use std::{
    io::{self, Write},
    mem,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// A frame that has waited for longer is of no use any more.
const MOST_AGE: Duration = Duration::from_secs(1);
/// Most frames that wait: those of a second, or fewer.
const MOST_WAITING: usize = 1024;
/// How long a reader who stalls is waited for at the end.
const LAST_WAIT: Duration = Duration::from_secs(2);

/// Standard output, one text for each frame.
pub(in crate::commands) struct Lines {
    /// None once it has ended.
    texts: Option<SyncSender<Text>>,
    writer: Option<JoinHandle<io::Result<()>>>,
    /// What is no frame and waits for the next.
    remarks: String,
    dropped: Arc<AtomicU64>,
}

struct Text {
    /// Written whatever its age.
    remarks: String,
    frame: String,
    made: Instant,
}

impl Lines {
    /// Starts to write; `remark` makes a line of the number of frames that were dropped.
    pub(in crate::commands) fn start(remark: fn(u64) -> String) -> io::Result<Self> {
        let (texts, waiting) = sync_channel(MOST_WAITING);
        let dropped = Arc::<AtomicU64>::default();
        let counted = dropped.clone();
        let write = move || write_all(&waiting, &mut io::stdout(), &counted, remark);
        let writer = thread::Builder::new().name("lines".to_owned()).spawn(write)?;
        Ok(Self { texts: Some(texts), writer: Some(writer), remarks: String::new(), dropped })
    }

    /// Frames that nobody got because the reader stalled.
    pub(in crate::commands) fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Writes a line in front of the next frame.
    pub(in crate::commands) fn remark(&mut self, line: &str) {
        self.remarks.push_str(line);
        self.remarks.push('\n');
    }

    /// Writes the lines of a frame, or drops them if too many wait. The error is that of writing earlier ones.
    pub(in crate::commands) fn frame(&mut self, frame: String) -> io::Result<()> {
        let Some(texts) = &self.texts else { return Err(io::ErrorKind::BrokenPipe.into()) };
        let text = Text { remarks: mem::take(&mut self.remarks), frame, made: Instant::now() };
        match texts.try_send(text) {
            Ok(()) => Ok(()),
            Err(TrySendError::Full(text)) => {
                self.remarks = text.remarks;
                count(&self.dropped);
                Ok(())
            }
            Err(TrySendError::Disconnected(_)) => self.end(),
        }
    }

    /// Writes what waits, as far as the reader takes it.
    pub(in crate::commands) fn end(&mut self) -> io::Result<()> {
        self.texts = None;
        let Some(writer) = self.writer.take() else { return Ok(()) };
        let started = Instant::now();
        while !writer.is_finished() {
            if started.elapsed() > LAST_WAIT {
                // It ends with the program.
                return Ok(());
            }
            thread::sleep(Duration::from_millis(1));
        }
        writer.join().unwrap_or_else(|_| Err(io::Error::other("the writer of lines has panicked")))
    }
}

/// Counts a frame that is dropped, and says so at the first.
fn count(dropped: &AtomicU64) {
    if dropped.fetch_add(1, Ordering::Relaxed) == 0 {
        let seconds = MOST_AGE.as_secs();
        eprintln!(
            "warning: standard output is not read fast enough: frames that wait for {seconds} s are dropped"
        );
    }
}

fn write_all(
    texts: &Receiver<Text>,
    out: &mut impl Write,
    dropped: &AtomicU64,
    remark: fn(u64) -> String,
) -> io::Result<()> {
    let mut told = 0;
    for text in texts {
        out.write_all(text.remarks.as_bytes())?;
        if text.made.elapsed() > MOST_AGE {
            count(dropped);
            continue;
        }
        let new = dropped.load(Ordering::Relaxed) - told;
        if new > 0 {
            writeln!(out, "{}", remark(new))?;
            told += new;
        }
        out.write_all(text.frame.as_bytes())?;
        out.flush()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_waited_too_long_are_dropped_and_a_line_stands_in_their_place() {
        let (texts, waiting) = sync_channel(9);
        let now = Instant::now();
        let Some(old) = now.checked_sub(2 * MOST_AGE) else { return };
        for (remarks, frame, made) in
            [("", "1\n", old), ("gap\n", "2\n", old), ("", "3\n", now), ("", "4\n", now)]
        {
            texts.send(Text { remarks: remarks.to_owned(), frame: frame.to_owned(), made }).unwrap();
        }
        drop(texts);
        let (mut out, dropped) = (Vec::new(), AtomicU64::new(0));
        write_all(&waiting, &mut out, &dropped, |frames| format!("dropped {frames}")).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), "gap\ndropped 2\n3\n4\n");
        assert_eq!(dropped.into_inner(), 2);
    }
}
