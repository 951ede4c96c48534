//! Listener: hears what all computers say of a robot.

use crate::{
    key::{Space, Topic, all_alive, of_all},
    message::{self, Contacts, DecodeError, Message, Stamp, State},
    settings::{Settings, ZenohError},
};
use dermatome_messages::clock::now_ns;
use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    time::{Duration, Instant},
};
use zenoh::{
    Session, Wait,
    pubsub::Subscriber,
    query::ConsolidationMode,
    sample::{Sample, SampleKind},
};

/// Most that waits to be taken.
const MOST_WAITING: usize = 8192;
/// Contacts that have waited for longer are of no use any more.
const MOST_AGE: Duration = Duration::from_secs(1);
/// Most that may say they serve a skin.
const MOST_ALIVE: usize = 4096;
/// How often computers are asked for their time, and the first times.
const ASKED: Duration = Duration::from_secs(1);
const FIRST_ASKED: Duration = Duration::from_millis(150);
const FIRST: u32 = 8;
/// How long an answer may take.
const ANSWERED: Duration = Duration::from_secs(1);
/// How often robots are looked for.
pub(crate) const LOOK: Duration = Duration::from_millis(200);

/// What was heard.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// A run of a program serves this skin.
    Alive {
        /// The skin.
        space: Space,
        /// Which run.
        run: u64,
    },
    /// It does no longer, or is cut off.
    Gone {
        /// The skin.
        space: Space,
        /// Which run.
        run: u64,
    },
    /// Contacts of a frame.
    Contacts {
        /// The skin.
        space: Space,
        /// Who sent them, and how many before.
        stamp: Stamp,
        /// As they were sent.
        contacts: Box<Contacts>,
        /// When they came, by this computer's clock, ns since 1970.
        received_ns: u64,
    },
    /// How a board stands.
    State {
        /// The skin.
        space: Space,
        /// Who sent it.
        stamp: Stamp,
        /// As it was sent.
        state: State,
    },
    /// What a run's computer has as time, ns since 1970.
    Clock {
        /// Which run.
        run: u64,
        /// When it was asked, by this computer's clock.
        asked_ns: u64,
        /// What it said.
        theirs_ns: u64,
        /// When the answer came, by this computer's clock.
        answered_ns: u64,
    },
    /// Bytes that are no message.
    Unreadable {
        /// Under the keys of this skin.
        space: Space,
        /// Why.
        error: DecodeError,
    },
}

/// Hears all skins of one robot.
pub struct Listener {
    session: Session,
    robot: String,
    outbox: Outbox,
    waiting: Receiver<(Instant, Heard)>,
    alive: Arc<Alive>,
    /// Of those, what has been told.
    known: BTreeSet<(Space, u64)>,
    changed: VecDeque<Heard>,
    /// Runs that are asked for their time: how often so far, and when last.
    asked: BTreeMap<u64, (u32, Option<Instant>)>,
    _subscribers: [Subscriber<()>; 3],
}

/// Which runs serve which skins.
#[derive(Default)]
struct Alive {
    served: Mutex<BTreeSet<(Space, u64)>>,
    has_changed: AtomicBool,
}

impl Alive {
    fn note(&self, sample: &Sample) {
        let Some(key) = Space::of_alive(sample.key_expr().as_str()) else { return };
        let mut served = self.served();
        if sample.kind() == SampleKind::Delete {
            served.remove(&key);
        } else if served.len() < MOST_ALIVE {
            served.insert(key);
        }
        self.has_changed.store(true, Ordering::Release);
    }

    fn served(&self) -> MutexGuard<'_, BTreeSet<(Space, u64)>> {
        self.served.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Where callbacks put what they have heard; they wait for nobody.
#[derive(Clone)]
struct Outbox {
    sender: SyncSender<(Instant, Heard)>,
    dropped: Arc<AtomicU64>,
}

impl Outbox {
    fn put(&self, heard: Heard) {
        if self.sender.try_send((Instant::now(), heard)).is_err() {
            self.count_dropped();
        }
    }

    fn count_dropped(&self) {
        self.dropped.fetch_add(1, Ordering::Relaxed);
    }

    fn hear(&self, sample: &Sample) {
        let received_ns = now_ns();
        let Some((space, rest)) = Space::of_key(sample.key_expr().as_str()) else { return };
        let heard = match rest {
            "contacts" => read(sample).map(|(stamp, contacts)| Heard::Contacts {
                space: space.clone(),
                stamp,
                contacts: Box::new(contacts),
                received_ns,
            }),
            "state" => read(sample).map(|(stamp, state)| Heard::State { space: space.clone(), stamp, state }),
            _ => return,
        };
        self.put(heard.unwrap_or_else(|error| Heard::Unreadable { space, error }));
    }
}

/// The message of a sample, and its stamp.
fn read<M: Message>(sample: &Sample) -> Result<(Stamp, M), DecodeError> {
    let attachment = sample.attachment().map(|bytes| bytes.to_bytes()).unwrap_or_default();
    let stamp = message::stamp(&attachment)?;
    let payload = sample.payload();
    if payload.len() > message::MOST_BYTES {
        return Err(DecodeError::Damaged(payload.len()));
    }
    Ok((stamp, message::decode(&payload.to_bytes())?))
}

impl Listener {
    /// Of the robot of this name, or the only one that is found before `is_over`; none if there is none until then.
    pub fn open(
        robot: Option<&str>,
        settings: &Settings,
        is_over: impl Fn() -> bool,
    ) -> Result<Option<Self>, ZenohError> {
        let session = settings.open()?;
        let found = match robot {
            Some(robot) => Some(robot.to_owned()),
            None => find(&session, is_over)?,
        };
        found.map(|robot| Self::of(session, robot)).transpose()
    }

    fn of(session: Session, robot: String) -> Result<Self, ZenohError> {
        let (sender, waiting) = sync_channel(MOST_WAITING);
        let outbox = Outbox { sender, dropped: Arc::default() };
        let alive = Arc::<Alive>::default();
        let seen = alive.clone();
        let listen = |topic| {
            let outbox = outbox.clone();
            let subscriber = session.declare_subscriber(of_all(&robot, topic));
            subscriber.callback(move |sample| outbox.hear(&sample)).wait()
        };
        let subscribers = [
            listen(Topic::Contacts)?,
            listen(Topic::State)?,
            session
                .liveliness()
                .declare_subscriber(all_alive(Some(&robot)))
                .history(true)
                .callback(move |sample| seen.note(&sample))
                .wait()?,
        ];
        Ok(Self {
            session,
            robot,
            outbox,
            waiting,
            alive,
            known: BTreeSet::new(),
            changed: VecDeque::new(),
            asked: BTreeMap::new(),
            _subscribers: subscribers,
        })
    }

    /// The robot's name.
    #[must_use]
    pub fn robot(&self) -> &str {
        &self.robot
    }

    /// What was heard and found no room, or waited too long.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.outbox.dropped.load(Ordering::Relaxed)
    }

    /// What was heard next, if anything is within `wait`.
    pub fn next(&mut self, wait: Duration) -> Option<Heard> {
        if self.changed.is_empty() {
            self.see();
        }
        self.ask_times();
        self.changed.pop_front().or_else(|| self.newest(wait))
    }

    /// What waits, without contacts that are too old.
    fn newest(&self, wait: Duration) -> Option<Heard> {
        loop {
            let (came, heard) = self.waiting.recv_timeout(wait).ok()?;
            if came.elapsed() <= MOST_AGE || !matches!(heard, Heard::Contacts { .. }) {
                return Some(heard);
            }
            self.outbox.count_dropped();
        }
    }

    /// Leaves the network.
    pub fn end(self) {
        if let Err(error) = self.session.close().wait() {
            log::debug!("Zenoh does not close: {error}");
        }
    }

    /// Who has come and gone.
    fn see(&mut self) {
        if !self.alive.has_changed.swap(false, Ordering::Acquire) {
            return;
        }
        let now = self.alive.served().clone();
        let before = std::mem::replace(&mut self.known, now);
        for (space, run) in before.difference(&self.known) {
            self.changed.push_back(Heard::Gone { space: space.clone(), run: *run });
        }
        for (space, run) in self.known.difference(&before) {
            self.changed.push_back(Heard::Alive { space: space.clone(), run: *run });
            self.ask(space, Topic::State);
        }
        let runs: BTreeSet<u64> = self.known.iter().map(|(_, run)| *run).collect();
        self.asked.retain(|run, _| runs.contains(run));
        runs.into_iter().for_each(|run| {
            self.asked.entry(run).or_default();
        });
    }

    /// Asks each computer for its time, where it is time.
    fn ask_times(&mut self) {
        let now = Instant::now();
        let mut due = Vec::new();
        for (run, (times, last)) in &mut self.asked {
            let period = if *times < FIRST { FIRST_ASKED } else { ASKED };
            if last.is_none_or(|last| now.duration_since(last) >= period) {
                (*times, *last) = (times.saturating_add(1), Some(now));
                due.extend(self.known.iter().find(|(_, other)| other == run).map(|(space, _)| space));
            }
        }
        due.into_iter().for_each(|space| self.ask(space, Topic::Clock));
    }

    fn ask(&self, space: &Space, topic: Topic) {
        let (outbox, asked_ns) = (self.outbox.clone(), now_ns());
        let asked = self
            .session
            .get(space.of(topic))
            .consolidation(ConsolidationMode::None)
            .timeout(ANSWERED)
            .callback(move |reply| {
                let answered_ns = now_ns();
                let Ok(sample) = reply.result() else { return };
                if topic != Topic::Clock {
                    return outbox.hear(sample);
                }
                if let Ok((Stamp { run, .. }, theirs_ns)) = read(sample) {
                    outbox.put(Heard::Clock { run, asked_ns, theirs_ns, answered_ns });
                }
            })
            .wait();
        if let Err(error) = asked {
            log::debug!("`{space}` is not asked: {error}");
        }
    }
}

/// The only robot that is there, once one is.
pub(crate) fn find(session: &Session, is_over: impl Fn() -> bool) -> Result<Option<String>, ZenohError> {
    while !is_over() {
        let mut robots: BTreeSet<String> =
            alive(session, None)?.into_keys().map(|space| space.robot).collect();
        match robots.len() {
            0 => std::thread::sleep(LOOK),
            1 => return Ok(robots.pop_first()),
            _ => {
                return Err(ZenohError::Robots(robots.into_iter().take(16).collect::<Vec<_>>().join("`, `")));
            }
        }
    }
    Ok(None)
}

/// The skins of a robot, or of all, that are served now, each with the runs of programs that say so.
pub(crate) fn alive(
    session: &Session,
    robot: Option<&str>,
) -> Result<BTreeMap<Space, BTreeSet<u64>>, ZenohError> {
    let replies = session.liveliness().get(all_alive(robot)).timeout(ANSWERED).wait()?;
    let mut there = BTreeMap::<_, BTreeSet<_>>::new();
    while let Ok(reply) = replies.recv() {
        let key = reply.result().ok().map(|sample| sample.key_expr().as_str().to_owned());
        if let Some((space, run)) = key.and_then(|key| Space::of_alive(&key)) {
            there.entry(space).or_default().insert(run);
        }
    }
    Ok(there)
}
