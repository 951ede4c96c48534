//! Write: messages into an MCAP file, on a thread of its own, so that a slow disk holds nobody up.
//!
//! Chunks are written whole, one a second or more often: a file that ends anywhere is readable up to its last whole
//! chunk. Where the disk is full the file is cut back to that place, and stays a recording.

use crate::session::{METADATA, PATCH, SKIN_FILE, Session};
use dermatome_messages::{
    Packed, Topic,
    clock::now_ns,
    schema,
    topic::{ENCODING, SCHEMA_ENCODING},
};
use mcap::{
    Attachment, Compression, McapError, WriteOptions, Writer,
    records::{MessageHeader, Metadata},
};
use std::{
    borrow::Cow,
    collections::BTreeMap,
    fs::{File, OpenOptions},
    io::{self, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// Bytes of messages that make a chunk.
const CHUNK_BYTES: u64 = 512 * 1024;
/// A chunk is written after so long, whatever it holds.
const CHUNK_TIME: Duration = Duration::from_secs(1);
/// Most batches of messages that wait for the disk: some seconds of the fastest board.
const MOST_WAITING: usize = 4096;

/// Why nothing is recorded, or no longer.
#[derive(Debug, thiserror::Error)]
#[error("cannot record to `{}`: {reason}", path.display())]
pub struct RecordError {
    /// The file.
    pub path: PathBuf,
    /// What the system says.
    pub reason: String,
}

/// How far a recording has come.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recorded {
    /// Frames whose raw codes are in it.
    pub frames: u64,
    /// Messages.
    pub messages: u64,
    /// Length of the file, bytes.
    pub bytes: u64,
    /// Messages that were dropped, because the disk was too slow.
    pub dropped: u64,
    /// Why it ended early.
    pub failure: Option<String>,
}

/// A recording under way. Dropping it ends it.
#[derive(Debug)]
pub struct Recorder {
    path: PathBuf,
    /// None once it has ended.
    batches: Option<SyncSender<Vec<Packed>>>,
    writer: Option<JoinHandle<()>>,
    state: Arc<Mutex<Recorded>>,
    waits: bool,
}

impl Recorder {
    /// Begins a file, which replaces one that is there.
    pub fn create(path: &Path, session: &Session) -> Result<Self, RecordError> {
        let refuse = |reason: String| RecordError { path: path.to_owned(), reason };
        let disk = Disk::create(path).map_err(|error| refuse(error.to_string()))?;
        let state = disk.state.clone();
        let tape = Tape::begin(disk, session).map_err(|error| refuse(in_words(&error)))?;
        let (batches, waiting) = sync_channel(MOST_WAITING);
        let writer = thread::Builder::new().name("recorder".to_owned());
        let writer =
            writer.spawn(move || tape.write_all(&waiting)).map_err(|error| refuse(error.to_string()))?;
        Ok(Self { path: path.to_owned(), batches: Some(batches), writer: Some(writer), state, waits: false })
    }

    /// The same, which waits for a slow disk instead of dropping messages: for those that do not come from a board.
    #[must_use]
    pub fn waiting(mut self) -> Self {
        self.waits = true;
        self
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Takes messages that belong together. They are in the file within a second or so.
    pub fn record(&mut self, messages: Vec<Packed>) {
        let Some(batches) = &self.batches else { return };
        if self.waits {
            // Where it has ended early, its state says why.
            let _ = batches.send(messages);
        } else if let Err(TrySendError::Full(messages)) = batches.try_send(messages) {
            self.state().dropped += messages.len() as u64;
        }
    }

    /// How far it has come.
    #[must_use]
    pub fn recorded(&self) -> Recorded {
        self.state().clone()
    }

    /// Ends the file.
    pub fn finish(mut self) -> Result<Recorded, RecordError> {
        self.end();
        let recorded = self.recorded();
        match &recorded.failure {
            Some(reason) => Err(RecordError { path: self.path.clone(), reason: reason.clone() }),
            None => Ok(recorded),
        }
    }

    fn state(&self) -> std::sync::MutexGuard<'_, Recorded> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn end(&mut self) {
        self.batches = None;
        if let Some(writer) = self.writer.take()
            && writer.join().is_err()
        {
            self.state().failure.get_or_insert_with(|| "the recorder has crashed".to_owned());
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.end();
    }
}

/// The words of an error of MCAP's writer: the system's, without its own name for them.
fn in_words(error: &McapError) -> String {
    match error {
        McapError::Io(error) => error.to_string(),
        other => other.to_string(),
    }
}

/// How `ros2 bag play` is to publish a topic, as MCAP's profile of ROS 2 asks for: what lasts goes to those who come
/// later as well, without which nobody hears of `/tf_static`.
fn channel_metadata(topic: Topic) -> BTreeMap<String, String> {
    // Of ROS' numbers: keep the last; reliable; transient local or volatile; alive by itself; without end.
    let (depth, durability) = if topic.is_lasting() { (1, 1) } else { (10, 2) };
    let endless = "{sec: 9223372036, nsec: 854775807}";
    let profile = format!(
        "- {{history: 1, depth: {depth}, reliability: 1, durability: {durability}, deadline: {endless}, \
         lifespan: {endless}, liveliness: 1, liveliness_lease_duration: {endless}, \
         avoid_ros_namespace_conventions: false}}"
    );
    [("offered_qos_profiles".to_owned(), profile)].into()
}

/// The file: after the first error it takes nothing more.
struct Disk {
    file: File,
    state: Arc<Mutex<Recorded>>,
    has_failed: bool,
}

impl Disk {
    fn create(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().write(true).create(true).truncate(true).open(path)?;
        Ok(Self { file, state: Arc::default(), has_failed: false })
    }

    fn unless_failed<T>(&mut self, act: impl FnOnce(&mut File) -> io::Result<T>) -> io::Result<T> {
        if self.has_failed {
            return Err(io::Error::other("nothing is written after an error"));
        }
        let done = act(&mut self.file);
        self.has_failed = done.as_ref().is_err_and(|error| error.kind() != io::ErrorKind::Interrupted);
        done
    }
}

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.unless_failed(|file| file.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.unless_failed(File::flush)
    }
}

impl Seek for Disk {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.unless_failed(|file| file.seek(to))
    }
}

/// An MCAP file that is being written.
struct Tape {
    writer: Writer<Disk>,
    file: File,
    state: Arc<Mutex<Recorded>>,
    /// `[topic]`, with the number of the next message.
    channels: Vec<(u16, u32)>,
    /// Length up to the last whole chunk.
    whole: u64,
    flushed: Instant,
}

impl Tape {
    fn begin(disk: Disk, session: &Session) -> Result<Self, McapError> {
        let (state, file) = (disk.state.clone(), disk.file.try_clone()?);
        let options = WriteOptions::new()
            .compression(Some(Compression::Lz4))
            .profile("ros2")
            .library(format!("dermatome {}", session.host))
            .chunk_size(Some(CHUNK_BYTES))
            // A chunk goes into the file when it is whole.
            .disable_seeking(true);
        let mut writer = options.create(disk)?;
        writer.write_metadata(&Metadata { name: METADATA.to_owned(), metadata: session.metadata() })?;
        let now = now_ns();
        let attachment = |name: &str, media_type: &str, data: &'_ [u8]| Attachment {
            log_time: now,
            create_time: now,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: Cow::Owned(data.to_owned()),
        };
        writer.attach(&attachment(PATCH, "application/octet-stream", &session.patch))?;
        if let Some(text) = &session.skin_file {
            writer.attach(&attachment(SKIN_FILE, "application/toml", text.as_bytes()))?;
        }
        let mut channels = Vec::new();
        for topic in Topic::ALL.into_iter().filter(|topic| !topic.is_of_robot()) {
            let schema = topic.schema();
            let text = schema::definition(schema);
            let schema = writer.add_schema(schema.name, SCHEMA_ENCODING, text.as_bytes())?;
            channels.push((writer.add_channel(schema, topic.name(), ENCODING, &channel_metadata(topic))?, 0));
        }
        let mut tape = Self { writer, file, state, channels, whole: 0, flushed: Instant::now() };
        tape.mark_whole()?;
        Ok(tape)
    }

    /// Writes what comes until nobody is left to send.
    fn write_all(mut self, batches: &Receiver<Vec<Packed>>) {
        let written = self.write_batches(batches).and_then(|()| {
            self.writer.finish()?;
            Ok(self.mark_whole()?)
        });
        if let Err(error) = written {
            // What is after the last whole chunk is half of one.
            let cut = self.file.set_len(self.whole);
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            state.bytes = self.whole;
            let reason = in_words(&error);
            state.failure = Some(match cut {
                Ok(()) => format!("{reason}; it holds all up to the second before"),
                Err(_) => reason,
            });
        }
    }

    fn write_batches(&mut self, batches: &Receiver<Vec<Packed>>) -> Result<(), McapError> {
        for batch in batches {
            let count = batch.len() as u64;
            let frames = batch.iter().filter(|packed| packed.topic == Topic::Measurements).count() as u64;
            batch.into_iter().try_for_each(|packed| self.write(&packed))?;
            {
                let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
                (state.messages, state.frames) = (state.messages + count, state.frames + frames);
            }
            if self.flushed.elapsed() >= CHUNK_TIME {
                self.writer.flush()?;
                self.mark_whole()?;
            }
        }
        Ok(())
    }

    fn write(&mut self, packed: &Packed) -> Result<(), McapError> {
        // Those of a robot, which come last, are not recorded: a recording is of one skin.
        let Some((channel_id, sequence)) = self.channels.get_mut(packed.topic.index()) else { return Ok(()) };
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: *sequence,
            log_time: packed.log_time,
            publish_time: packed.publish_time,
        };
        *sequence = sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, &packed.bytes)
    }

    /// All that is in the file now is whole.
    fn mark_whole(&mut self) -> io::Result<()> {
        self.whole = self.file.stream_position()?;
        self.flushed = Instant::now();
        self.state.lock().unwrap_or_else(PoisonError::into_inner).bytes = self.whole;
        Ok(())
    }
}
