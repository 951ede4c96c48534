//! Write: messages into an MCAP file, on a thread of its own, so that a slow disk holds nobody up.
//!
//! Chunks are written whole, one a second or more often: a file that ends anywhere is readable up to its last whole
//! chunk. Where the disk is full the file is cut back to that place, and stays a recording.

use crate::session::{Body, METADATA, PATCH, SKIN_FILE, Session, attached};
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
    collections::{BTreeMap, HashMap},
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
/// So many times that at most, for several boards.
const MOST_TIMES: usize = 16;

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

/// A recording under way, or one skin's part of it. Dropping it and all its parts ends it.
#[derive(Debug)]
pub struct Recorder {
    path: PathBuf,
    /// None once it has ended.
    entries: Option<SyncSender<Entry>>,
    writer: Option<Arc<Thread>>,
    state: Arc<Mutex<Recorded>>,
    waits: bool,
    /// Which of the skins, or [`OF_ROBOT`].
    skin: usize,
    /// Whether it is known what is recorded.
    has_begun: bool,
}

/// In place of a skin's: what is of the whole robot.
const OF_ROBOT: usize = usize::MAX;

/// What goes into the file of one of its skins.
#[derive(Debug)]
enum Entry {
    /// Its board is there.
    Session(usize, Box<Session>),
    /// Messages that belong together.
    Messages(usize, Vec<Packed>),
}

/// The thread that writes, for whoever ends last.
#[derive(Debug)]
struct Thread(JoinHandle<()>);

impl Recorder {
    /// Begins a file of one skin, which replaces one that is there.
    pub fn create(path: &Path, session: &Session) -> Result<Self, RecordError> {
        let begin = |disk| {
            let mut tape = Tape::begin(disk, &session.host, vec![None])?;
            tape.add(0, session)?;
            Ok(tape)
        };
        let mut recorder = Self::start(path, MOST_WAITING, begin)?;
        recorder.has_begun = true;
        Ok(recorder)
    }

    /// The same of all skins of a body, each of which is a [`Self::part`] of it. `host` is the version of the program that
    /// records.
    pub fn create_of_body(path: &Path, host: &str, body: &Body) -> Result<Self, RecordError> {
        let spaces = body.patches.iter().map(|patch| Some(body.space(patch))).collect();
        let begin = |disk| {
            let mut tape = Tape::begin(disk, host, spaces)?;
            tape.describe(METADATA.to_owned(), body.metadata(host))?;
            Ok(tape)
        };
        Self::start(path, MOST_WAITING * body.patches.len().clamp(1, MOST_TIMES), begin)
    }

    /// The part of the body's patch of this place, which takes messages once it has begun. The file ends with the last part and
    /// the whole.
    #[must_use]
    pub fn part(&self, skin: usize) -> Self {
        Self {
            path: self.path.clone(),
            entries: self.entries.clone(),
            writer: self.writer.clone(),
            state: self.state.clone(),
            waits: self.waits,
            skin,
            has_begun: false,
        }
    }

    /// The part of what is of the whole robot, not of one of its skins. It takes messages from the beginning.
    #[must_use]
    pub fn of_robot(&self) -> Self {
        let mut part = self.part(OF_ROBOT);
        part.has_begun = true;
        part
    }

    fn start(
        path: &Path,
        most_waiting: usize,
        begin: impl FnOnce(Disk) -> Result<Tape, McapError>,
    ) -> Result<Self, RecordError> {
        let refuse = |reason: String| RecordError { path: path.to_owned(), reason };
        let disk = Disk::create(path).map_err(|error| refuse(error.to_string()))?;
        let state = disk.state.clone();
        let tape = begin(disk).and_then(Tape::whole).map_err(|error| refuse(in_words(&error)))?;
        let (entries, waiting) = sync_channel(most_waiting);
        let writer = thread::Builder::new().name("recorder".to_owned());
        let writer =
            writer.spawn(move || tape.write_all(&waiting)).map_err(|error| refuse(error.to_string()))?;
        Ok(Self {
            path: path.to_owned(),
            entries: Some(entries),
            writer: Some(Arc::new(Thread(writer))),
            state,
            waits: false,
            skin: 0,
            has_begun: false,
        })
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

    /// The board of a body's skin is there: its messages are recorded from now on.
    pub fn begin(&mut self, session: &Session) {
        let Some(entries) = &self.entries else { return };
        // Where it has ended early, its state says why.
        let _ = entries.send(Entry::Session(self.skin, Box::new(session.clone())));
        self.has_begun = true;
    }

    /// Takes messages that belong together. They are in the file within a second or so.
    pub fn record(&mut self, messages: Vec<Packed>) {
        let Some(entries) = self.entries.as_ref().filter(|_| self.has_begun) else { return };
        let entry = Entry::Messages(self.skin, messages);
        if self.waits {
            // Where it has ended early, its state says why.
            let _ = entries.send(entry);
        } else if let Err(TrySendError::Full(Entry::Messages(_, messages))) = entries.try_send(entry) {
            self.state().dropped += messages.len() as u64;
        }
    }

    /// How far it has come.
    #[must_use]
    pub fn recorded(&self) -> Recorded {
        self.state().clone()
    }

    /// Ends the file, or this part of it.
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
        self.entries = None;
        if let Some(Thread(writer)) = self.writer.take().and_then(Arc::into_inner)
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
    /// The space of each skin; none where there is but one.
    spaces: Vec<Option<String>>,
    /// By skin and topic; none before its board is there.
    channels: HashMap<(usize, Topic), u16>,
    /// Of each channel, the number of the next message.
    numbers: HashMap<u16, u32>,
    /// Length up to the last whole chunk.
    whole: u64,
    flushed: Instant,
}

impl Tape {
    fn begin(disk: Disk, host: &str, spaces: Vec<Option<String>>) -> Result<Self, McapError> {
        let (state, file) = (disk.state.clone(), disk.file.try_clone()?);
        let options = WriteOptions::new()
            .compression(Some(Compression::Lz4))
            .profile("ros2")
            .library(format!("dermatome {host}"))
            .chunk_size(Some(CHUNK_BYTES))
            // A chunk goes into the file when it is whole.
            .disable_seeking(true);
        let writer = options.create(disk)?;
        let channels = HashMap::new();
        let (numbers, flushed) = (HashMap::new(), Instant::now());
        Ok(Self { writer, file, state, spaces, channels, numbers, whole: 0, flushed })
    }

    fn whole(mut self) -> Result<Self, McapError> {
        self.mark_whole()?;
        Ok(self)
    }

    fn describe(&mut self, name: String, metadata: BTreeMap<String, String>) -> Result<(), McapError> {
        self.writer.write_metadata(&Metadata { name, metadata })
    }

    /// The board of a skin is there: what it is of, and where its messages go.
    fn add(&mut self, skin: usize, session: &Session) -> Result<(), McapError> {
        let space = self.spaces[skin].clone();
        self.describe(attached(METADATA, space.as_deref()), session.metadata())?;
        let now = now_ns();
        let attachment = |name: &str, media_type: &str, data: &'_ [u8]| Attachment {
            log_time: now,
            create_time: now,
            name: attached(name, space.as_deref()),
            media_type: media_type.to_owned(),
            data: Cow::Owned(data.to_owned()),
        };
        self.writer.attach(&attachment(PATCH, "application/octet-stream", &session.patch))?;
        if let Some(text) = &session.skin_file {
            self.writer.attach(&attachment(SKIN_FILE, "application/toml", text.as_bytes()))?;
        }
        self.mark_whole()?;
        Topic::ALL
            .into_iter()
            .filter(|topic| !topic.is_of_robot())
            .try_for_each(|topic| self.open(skin, topic).map(drop))
    }

    /// Where messages of a topic go.
    fn open(&mut self, skin: usize, topic: Topic) -> Result<u16, McapError> {
        let schema = topic.schema();
        let text = schema::definition(schema);
        let schema = self.writer.add_schema(schema.name, SCHEMA_ENCODING, text.as_bytes())?;
        let space = self.spaces.get(skin).and_then(Option::as_deref);
        let name = space.map_or_else(|| topic.name().to_owned(), |space| topic.name_in(space));
        let channel = self.writer.add_channel(schema, &name, ENCODING, &channel_metadata(topic))?;
        self.channels.insert((skin, topic), channel);
        Ok(channel)
    }

    /// Writes what comes until nobody is left to send.
    fn write_all(mut self, entries: &Receiver<Entry>) {
        let written = self.write_entries(entries).and_then(|()| {
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

    fn write_entries(&mut self, entries: &Receiver<Entry>) -> Result<(), McapError> {
        for entry in entries {
            match entry {
                Entry::Session(skin, session) => self.add(skin, &session)?,
                Entry::Messages(skin, batch) => self.write_batch(skin, batch)?,
            }
            if self.flushed.elapsed() >= CHUNK_TIME {
                self.writer.flush()?;
                self.mark_whole()?;
            }
        }
        Ok(())
    }

    fn write_batch(&mut self, skin: usize, batch: Vec<Packed>) -> Result<(), McapError> {
        let count = batch.len() as u64;
        let frames = batch.iter().filter(|packed| packed.topic == Topic::Measurements).count() as u64;
        batch.into_iter().try_for_each(|packed| self.write(skin, &packed))?;
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        (state.messages, state.frames) = (state.messages + count, state.frames + frames);
        Ok(())
    }

    fn write(&mut self, skin: usize, packed: &Packed) -> Result<(), McapError> {
        let channel_id = match self.channels.get(&(skin, packed.topic)) {
            Some(&channel) => channel,
            None if skin == OF_ROBOT => self.open(skin, packed.topic)?,
            None => return Ok(()),
        };
        let sequence = self.numbers.entry(channel_id).or_default();
        let header = MessageHeader {
            channel_id,
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
