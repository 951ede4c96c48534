//! Read: the messages of an MCAP file, from its start on, up to where it was cut.

use crate::session::{METADATA, PATCH, SKIN_FILE, Session};
use dermatome_messages::{Packed, Topic};
use mcap::{
    McapError,
    records::{Record, op},
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
    /// `[channel]`.
    topics: HashMap<u16, Topic>,
    /// Messages that were read while looking for the session.
    ahead: VecDeque<Packed>,
    ending: Ending,
}

impl Recording {
    /// Whether a file begins as MCAP files do.
    #[must_use]
    pub fn is_one(path: &Path) -> bool {
        let mut start = [0; mcap::MAGIC.len()];
        let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
        read.is_ok() && start == mcap::MAGIC
    }

    /// Opens a file and reads what it is of.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let opened = File::open(path).and_then(|file| Ok((file.metadata()?.len(), file)));
        let (length, file) =
            opened.map_err(|error| ReadError { path: path.to_owned(), problem: Problem::Io(error) })?;
        Self::of(path, Box::new(file), length)
    }

    /// Reads what the bytes of `source`, about `length` of them, are of; `path` is for errors.
    pub fn of(path: &Path, source: Box<dyn Read + Send>, length: u64) -> Result<Self, ReadError> {
        let refuse = |problem| ReadError { path: path.to_owned(), problem };
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
            topics: HashMap::new(),
            ahead: VecDeque::new(),
            ending: Ending::Unknown,
        };
        let mut is_ours = false;
        // Metadata and patch come before the first message.
        while let Some(record) = recording.record()? {
            match record {
                Piece::Session(metadata) => (recording.session, is_ours) = (metadata, true),
                Piece::Patch(bytes) => recording.session.patch = bytes,
                Piece::SkinFile(text) => recording.session.skin_file = Some(text),
                Piece::Message(packed) => {
                    recording.ahead.push_back(packed);
                    break;
                }
            }
        }
        match (is_ours, recording.session.patch.is_empty()) {
            (true, false) => Ok(recording),
            (true, true) => Err(refuse(Problem::NoPatch)),
            (false, _) if recording.ending == Ending::Whole || !recording.ahead.is_empty() => {
                Err(refuse(Problem::NotOurs))
            }
            (false, _) => Err(refuse(Problem::NotMcap)),
        }
    }

    /// The file.
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
                    match piece(&mut self.topics, &self.session, opcode, data) {
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
    Session(Session),
    Patch(Vec<u8>),
    SkinFile(String),
    Message(Packed),
}

fn piece(
    topics: &mut HashMap<u16, Topic>,
    session: &Session,
    opcode: u8,
    data: &[u8],
) -> Result<Option<Piece>, McapError> {
    let is_wanted = matches!(opcode, op::CHANNEL | op::MESSAGE | op::METADATA | op::ATTACHMENT);
    // The library takes an attachment's length for granted.
    if !is_wanted || opcode == op::ATTACHMENT && !is_whole_attachment(data) {
        return Ok(None);
    }
    Ok(match mcap::parse_record(opcode, data)? {
        Record::Metadata(metadata) if metadata.name == METADATA => {
            let read = Session::of_metadata(&metadata.metadata);
            let (patch, skin_file) = (session.patch.clone(), session.skin_file.clone());
            Some(Piece::Session(Session { patch, skin_file, ..read }))
        }
        Record::Attachment { header, data, .. } => match header.name.as_str() {
            PATCH => Some(Piece::Patch(data.into_owned())),
            SKIN_FILE => String::from_utf8(data.into_owned()).ok().map(Piece::SkinFile),
            _ => None,
        },
        Record::Channel(channel) => {
            let topic = Topic::of_name(&channel.topic).filter(|_| channel.message_encoding == "cdr");
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

/// Whether the lengths in an attachment fit into it: two times, name, type, content, checksum.
fn is_whole_attachment(data: &[u8]) -> bool {
    let number = |at: usize| {
        let bytes = data.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?) as usize)
    };
    let end = || {
        let name_end = 20_usize.checked_add(number(16)?)?;
        let type_end = name_end.checked_add(4)?.checked_add(number(name_end)?)?;
        type_end.checked_add(8 + 4)
    };
    end().is_some_and(|least| least <= data.len())
}
