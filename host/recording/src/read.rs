//! Read: the messages of an MCAP file, from its start on, up to where it was cut.

use crate::{
    session::{Body, METADATA, PATCH, SKIN_FILE, Session, attached},
    whole::is_whole,
};
use dermatome_messages::{Packed, Topic};
use mcap::{
    McapError,
    records::{Metadata, Record, op},
    sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions},
};
use std::{
    collections::{BTreeMap, HashMap, VecDeque},
    fs::File,
    io::{self, Read},
    path::{Path, PathBuf},
};

/// Longest record that is read, bytes: chunks of others may be large, those of ours have half a MiB.
const LONGEST_RECORD: usize = 256 << 20;

/// Why a file is no recording.
#[derive(Debug, thiserror::Error)]
#[error("cannot read recording `{}`: {problem}", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub problem: Problem,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// It cannot be read.
    #[error("{0}")]
    Io(io::Error),
    /// Another format.
    #[error("it is no MCAP file, or ends before anything was recorded")]
    NotMcap,
    /// Of another program.
    #[error("it is an MCAP file of another program: it holds no metadata `{METADATA}`")]
    NotOurs,
    /// Cut before its patch.
    #[error("it ends within its first second, before the patch that its frames were recorded with")]
    NoPatch,
    /// Of several skins, of which none was named.
    #[error(
        "it is of the {} skins of the body `{}`; allowed: one of them behind the file's name: {}",
        .0.patches.len(), .0.name, behind(.0)
    )]
    Several(Body),
    /// Of other skins than the one that was named.
    #[error("it is not of a skin `{patch}`; allowed behind the file's name: {allowed}")]
    Other {
        /// What was named.
        patch: String,
        /// What may be.
        allowed: String,
    },
    /// Of several skins, and the board of this one was not there.
    #[error("it holds nothing of `{0}`: the skin's board had not answered when it ends")]
    Unheard(String),
    /// A message that is not what its topic says.
    #[error("a message on {topic} is damaged: {reason}")]
    Message {
        /// The topic.
        topic: &'static str,
        /// Why.
        reason: String,
    },
    /// A frame that its patch does not fit.
    #[error("frame {sequence} holds {found} {what}; its patch has {expected}")]
    Size {
        /// Which frame.
        sequence: u32,
        /// Of what.
        what: &'static str,
        /// How many it holds.
        found: usize,
        /// How many it should hold.
        expected: usize,
    },
    /// Its patch is of another version of this program, or damaged.
    #[error("its patch: {0}")]
    Patch(dermatome_shared::patch::PatchError),
}

/// How a recording ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ending {
    /// Not seen yet.
    Unknown,
    /// As it was meant to.
    Whole,
    /// In the middle: whoever recorded it was cut off, or the disk was full.
    Cut,
    /// Something else follows, or damaged bytes do.
    Damaged(String),
}

/// A recording, from its start on.
pub struct Recording {
    path: PathBuf,
    source: Box<dyn Read + Send>,
    /// Bytes of the file, and how many of them were read.
    length: u64,
    position: u64,
    reader: LinearReader,
    session: Session,
    /// Of a body, the space of the skin that is read.
    space: Option<String>,
    /// `[channel]`.
    topics: HashMap<u16, Topic>,
    /// Messages that were read while looking for the session.
    ahead: VecDeque<Packed>,
    ending: Ending,
}

/// The file of a recording, and the patch of its body that was named behind a colon, as in `run.mcap:palm`; only after a name
/// that ends in `.mcap`: `C:\run.mcap` names none.
#[must_use]
pub fn file_and_patch(text: &Path) -> (PathBuf, Option<String>) {
    let split = text.to_str().and_then(|text| text.rsplit_once(':'));
    match split.filter(|(file, _)| file.to_ascii_lowercase().ends_with(".mcap")) {
        Some((file, patch)) => (file.into(), Some(patch.to_owned())),
        None => (text.to_owned(), None),
    }
}

impl Recording {
    /// Whether a file begins as MCAP files do.
    #[must_use]
    pub fn is_one(path: &Path) -> bool {
        let mut start = [0; mcap::MAGIC.len()];
        let file = File::open(file_and_patch(path).0);
        let read = file.and_then(|mut file| file.read_exact(&mut start));
        read.is_ok() && start == mcap::MAGIC
    }

    /// Opens a file and reads what it is of. Of one of a whole body the patch stands [behind](file_and_patch) its name, unless it
    /// has but one.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let (file, patch) = file_and_patch(path);
        let opened = File::open(&file).and_then(|file| Ok((file.metadata()?.len(), file)));
        let (length, source) =
            opened.map_err(|error| ReadError { path: file.clone(), problem: Problem::Io(error) })?;
        Self::of_patch(path, patch.as_deref(), Box::new(source), length)
    }

    /// Reads what the bytes of `source`, about `length` of them, are of; `path` is for errors.
    pub fn of(path: &Path, source: Box<dyn Read + Send>, length: u64) -> Result<Self, ReadError> {
        Self::of_patch(path, None, source, length)
    }

    /// The same of this patch of a body.
    pub fn of_patch(
        path: &Path,
        patch: Option<&str>,
        source: Box<dyn Read + Send>,
        length: u64,
    ) -> Result<Self, ReadError> {
        let refuse = |problem| ReadError { path: file_and_patch(path).0, problem };
        let options = LinearReaderOptions::default()
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(LONGEST_RECORD);
        let mut recording = Self {
            path: path.to_owned(),
            source,
            length,
            position: 0,
            reader: LinearReader::new_with_options(options),
            session: Session::of_metadata(&BTreeMap::new()),
            space: None,
            topics: HashMap::new(),
            ahead: VecDeque::new(),
            ending: Ending::Unknown,
        };
        let mut is_ours = false;
        // Metadata and patch come before the first message of a skin.
        while let Some(record) = recording.record()? {
            match record {
                Piece::Body(body) => {
                    recording.space = Some(body.space(chosen(&body, patch).map_err(refuse)?));
                    is_ours = true;
                }
                Piece::Session(metadata) => (recording.session, is_ours) = (metadata, true),
                Piece::Patch(bytes) => recording.session.patch = bytes,
                Piece::SkinFile(text) => recording.session.skin_file = Some(text),
                Piece::Message(packed) => {
                    recording.ahead.push_back(packed);
                    break;
                }
            }
        }
        let Session { skin, patch: bytes, .. } = &recording.session;
        let other = patch.filter(|patch| recording.space.is_none() && skin != patch);
        match (is_ours, bytes.is_empty()) {
            (true, _) if other.is_some() => {
                let patch = other.unwrap_or_default().to_owned();
                Err(refuse(Problem::Other { patch, allowed: format!("nothing, or `{skin}`") }))
            }
            (true, false) => Ok(recording),
            (true, true) => Err(refuse(recording.space.map_or(Problem::NoPatch, Problem::Unheard))),
            (false, _) if recording.ending == Ending::Whole || !recording.ahead.is_empty() => {
                Err(refuse(Problem::NotOurs))
            }
            (false, _) => Err(refuse(Problem::NotMcap)),
        }
    }

    /// The file, with the patch of a body behind it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What it is of.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// When its first message came, ns since 1970; 0 where there is none. To be asked before any is taken.
    #[must_use]
    pub fn begun(&self) -> u64 {
        self.ahead.front().map_or(0, |packed| packed.log_time)
    }

    /// How it ends, once all of it was read.
    #[must_use]
    pub fn ending(&self) -> &Ending {
        &self.ending
    }

    /// How much of it was read, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f64 {
        self.position as f64 / self.length.max(1) as f64
    }

    /// The next message of a topic that is ours; none at the end, wherever that is.
    pub fn message(&mut self) -> Result<Option<Packed>, ReadError> {
        if let Some(packed) = self.ahead.pop_front() {
            return Ok(Some(packed));
        }
        while let Some(piece) = self.record()? {
            if let Piece::Message(packed) = piece {
                return Ok(Some(packed));
            }
        }
        Ok(None)
    }

    /// The error of something that is wrong with it.
    #[must_use]
    pub fn refuse(&self, problem: Problem) -> ReadError {
        ReadError { path: self.path.clone(), problem }
    }

    /// The next record that means something here.
    fn record(&mut self) -> Result<Option<Piece>, ReadError> {
        while self.ending == Ending::Unknown {
            let event = match self.reader.next_event() {
                Some(Ok(event)) => event,
                Some(Err(error)) => {
                    self.ending = ending_of(&error, self.position >= self.length);
                    break;
                }
                None => {
                    self.ending = Ending::Whole;
                    break;
                }
            };
            match event {
                LinearReadEvent::ReadRequest(wanted) => {
                    let read = self.source.read(self.reader.insert(wanted));
                    let read = read.map_err(|error| self.refuse(Problem::Io(error)))?;
                    self.position += read as u64;
                    self.reader.notify_read(read);
                }
                LinearReadEvent::Record { data, opcode } => {
                    let of =
                        Of { topics: &mut self.topics, session: &self.session, space: self.space.as_deref() };
                    match piece(of, opcode, data) {
                        Ok(Some(piece)) => return Ok(Some(piece)),
                        Ok(None) => {}
                        Err(error) => self.ending = Ending::Damaged(error.to_string()),
                    }
                }
            }
        }
        Ok(None)
    }
}

/// How a file ends where its reader gives up.
fn ending_of(error: &McapError, is_all_read: bool) -> Ending {
    match error {
        McapError::UnexpectedEof | McapError::UnexpectedEoc => Ending::Cut,
        // A chunk whose end is missing may fail in another way.
        _ if is_all_read => Ending::Cut,
        McapError::BadMagic => Ending::Damaged("its start or its end is not that of an MCAP file".to_owned()),
        error => Ending::Damaged(error.to_string()),
    }
}

/// What a record is to us.
enum Piece {
    Body(Body),
    Session(Session),
    Patch(Vec<u8>),
    SkinFile(String),
    Message(Packed),
}

/// What is known of a recording as a record comes.
struct Of<'a> {
    topics: &'a mut HashMap<u16, Topic>,
    session: &'a Session,
    space: Option<&'a str>,
}

fn piece(of: Of<'_>, opcode: u8, data: &[u8]) -> Result<Option<Piece>, McapError> {
    let is_wanted = matches!(opcode, op::CHANNEL | op::MESSAGE | op::METADATA | op::ATTACHMENT);
    if !is_wanted {
        return Ok(None);
    }
    if !is_whole(opcode, data) {
        // Without one attachment the rest may be of use.
        return if opcode == op::ATTACHMENT { Ok(None) } else { Err(McapError::UnexpectedEof) };
    }
    let Of { topics, session, space } = of;
    Ok(match mcap::parse_record(opcode, data)? {
        Record::Metadata(Metadata { name, metadata }) if name == attached(METADATA, space) => {
            let (patch, skin_file) = (session.patch.clone(), session.skin_file.clone());
            let of_skin = || Session { patch, skin_file, ..Session::of_metadata(&metadata) };
            Some(Body::of_metadata(&metadata).map_or_else(|| Piece::Session(of_skin()), Piece::Body))
        }
        Record::Attachment { header, data, .. } if header.name == attached(PATCH, space) => {
            Some(Piece::Patch(data.into_owned()))
        }
        Record::Attachment { header, data, .. } if header.name == attached(SKIN_FILE, space) => {
            String::from_utf8(data.into_owned()).ok().map(Piece::SkinFile)
        }
        Record::Channel(channel) => {
            let name = &channel.topic;
            let topic = space.map_or_else(|| Topic::of_name(name), |space| Topic::of_name_in(name, space));
            let topic = topic.filter(|_| channel.message_encoding == "cdr");
            topic.map(|topic| topics.insert(channel.id, topic));
            None
        }
        Record::Message { header, data } => topics.get(&header.channel_id).map(|&topic| {
            let (log_time, publish_time) = (header.log_time, header.publish_time);
            Piece::Message(Packed { topic, log_time, publish_time, bytes: (*data).into() })
        }),
        _ => None,
    })
}

/// The patch of a body that is read: the one that was named, or its only one.
fn chosen<'a>(body: &'a Body, patch: Option<&str>) -> Result<&'a str, Problem> {
    match (patch, &body.patches[..]) {
        (None, [only]) => Ok(only),
        (None, _) => Err(Problem::Several(body.clone())),
        (Some(patch), patches) => patches
            .iter()
            .find(|it| *it == patch)
            .map(String::as_str)
            .ok_or_else(|| Problem::Other { patch: patch.to_owned(), allowed: behind(body) }),
    }
}

/// What may stand behind the name of a body's recording.
fn behind(body: &Body) -> String {
    let patches: Vec<String> = body.patches.iter().map(|patch| format!("`:{patch}`")).collect();
    patches.join(", ")
}
