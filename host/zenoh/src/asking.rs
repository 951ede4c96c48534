//! Asking: what skins are asked to do over the network, by who asks and by who does it.

use crate::{
    key::{Order, Space},
    listener::{LOOK, alive, find},
    message::{self, DecodeError, MOST_BYTES, Stamp, Version, decode, encode, shortened},
    settings::{Settings, ZenohError},
};
use dermatome_body::{
    Sense,
    asking::{self, Outcome, Waiting},
    keeper::{Asked, Told},
};
use dermatome_messages::dermatome::DriveRequest;
use std::{
    collections::BTreeMap,
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, channel, sync_channel},
    thread,
    time::{Duration, Instant},
};
use zenoh::{
    Session, Wait,
    bytes::ZBytes,
    query::{ConsolidationMode, Query, Queryable},
    sample::Sample,
};

/// Most requests to one skin that are not answered yet.
const MOST_WAITING: usize = 32;
/// Until skins are there that somebody asks for.
const FOUND: Duration = Duration::from_secs(5);
/// How long no other skin must have come for all to be there.
const ALL_FOUND: Duration = Duration::from_secs(1);
/// How long somebody waits for what is asked for: a reference of the slowest frames takes longer.
const DONE: Duration = Duration::from_secs(300);
const NOT_ALLOWED: &str = "its computer takes no orders: start `dermatome serve` there with `--zenoh-orders`";

/// Takes what one skin is asked for, and answers when it is done.
pub(crate) struct Desk {
    asked: Receiver<(Order, Query)>,
    waiting: Waiting<Query>,
    /// Answers wait for who is slow in a thread of their own.
    answers: SyncSender<(Query, Outcome)>,
    _queryable: Queryable<()>,
}

impl Desk {
    /// Does what it is asked for, if that is allowed.
    pub(crate) fn open(
        session: &Session,
        space: &Space,
        run: u64,
        is_allowed: bool,
    ) -> Result<Self, ZenohError> {
        let (sender, asked) = sync_channel(MOST_WAITING);
        let (answers, answered) = sync_channel::<(Query, Outcome)>(2 * MOST_WAITING);
        let skin = space.clone();
        thread::Builder::new()
            .name("answers".to_owned())
            .spawn(move || answered.iter().for_each(|(query, outcome)| answer(&skin, run, &query, &outcome)))
            .map_err(|error| ZenohError::Zenoh(error.to_string()))?;
        let refuse = answers.clone();
        let queryable = session
            .declare_queryable(space.of_orders())
            .callback(move |query| {
                // Where it is full, who asks is told that nobody answered; and one that but reads all there is asks for nothing.
                let _ = match order(&query) {
                    None => return,
                    Some(_) if !is_allowed => refuse.try_send((query, Outcome::refused(NOT_ALLOWED))).is_ok(),
                    Some(Err(words)) => refuse.try_send((query, Outcome::refused(words))).is_ok(),
                    Some(Ok(order)) => sender.try_send((order, query)).is_ok(),
                };
            })
            .wait()?;
        Ok(Self { asked, waiting: Waiting::default(), answers, _queryable: queryable })
    }

    /// Takes what has been asked for; what cannot be done is answered.
    pub(crate) fn requests(&mut self, sense: &Sense) -> Vec<Asked> {
        let mut wanted = Vec::new();
        for (order, query) in self.asked.try_iter().take(MOST_WAITING) {
            let decided = if self.waiting.count() < MOST_WAITING {
                decide(order, &query, sense)
            } else {
                Err(Outcome::refused("too much is asked at once"))
            };
            match decided {
                Ok(asked) => {
                    self.waiting.add(query, &asked);
                    wanted.push(asked);
                }
                Err(outcome) => drop(self.answers.try_send((query, outcome))),
            }
        }
        wanted
    }

    /// Answers the requests that this decides.
    pub(crate) fn hear(&mut self, told: &Told) {
        let answers = &self.answers;
        self.waiting.hear(told, |query, outcome| drop(answers.try_send((query, outcome))));
    }
}

/// What a query asks for, by its key; none where that has no part `ask`, but stands for many.
fn order(query: &Query) -> Option<Result<Order, &'static str>> {
    let (_, order) = query.key_expr().as_str().rsplit_once("/ask/")?;
    let order = [Order::Tare, Order::Drive].into_iter().find(|known| known.name() == order);
    Some(order.ok_or("allowed: `ask/tare` or `ask/drive`"))
}

fn decide(order: Order, query: &Query, sense: &Sense) -> Result<Asked, Outcome> {
    let unreadable = |error: DecodeError| Outcome::refused(format!("the request is not read: {error}"));
    if let Some(stamp) = query.attachment() {
        message::stamp(&stamp.to_bytes()).map_err(unreadable)?;
    }
    match order {
        Order::Tare => asking::tare(sense),
        Order::Drive => {
            let payload = query.payload().map(payload).transpose().map_err(unreadable)?;
            asking::drive(&decode(&payload.unwrap_or_default()).map_err(unreadable)?, sense)
        }
    }
}

/// Answers in the name of a skin.
fn answer(space: &Space, run: u64, query: &Query, outcome: &Outcome) {
    // Who asks for neither is answered under a key that belongs to what was asked.
    let key = space.of_order(order(query).and_then(Result::ok).unwrap_or(Order::Tare));
    let stamp = Stamp { version: Version::OURS, run, number: 0 };
    let outcome = Outcome { message: shortened(&outcome.message), success: outcome.success };
    if let Err(error) = query.reply(&key, encode(&outcome)).attachment(encode(&stamp)).wait() {
        log::debug!("`{key}` is not answered: {error}");
    }
}

/// Asks the skins of a robot that have these names, or all where there are none, for a new reference, or to be driven like
/// that, and tells what became of it; the robot may be left out where there is only one.
pub fn ask(
    robot: Option<&str>,
    patches: &[String],
    drive: Option<&DriveRequest>,
    settings: &Settings,
    is_over: impl Fn() -> bool,
    mut tell: impl FnMut(&Space, Outcome),
) -> Result<(), ZenohError> {
    let session = settings.open()?;
    let found = match robot {
        Some(robot) => Some(robot.to_owned()),
        None => {
            let begun = Instant::now();
            find(&session, || is_over() || begun.elapsed() >= FOUND)?
        }
    };
    if let Some(robot) = found {
        let skins = skins(&session, &robot, patches, &is_over)?;
        ask_each(&session, &skins, drive, is_over, &mut tell)?;
    }
    session.close().wait()?;
    Ok(())
}

fn ask_each(
    session: &Session,
    skins: &[Space],
    drive: Option<&DriveRequest>,
    is_over: impl Fn() -> bool,
    tell: &mut impl FnMut(&Space, Outcome),
) -> Result<(), ZenohError> {
    let (sender, answers) = channel();
    for (index, space) in skins.iter().enumerate() {
        let (order, payload) = drive.map_or((Order::Tare, Vec::new()), |drive| (Order::Drive, encode(drive)));
        let stamp = Stamp { version: Version::OURS, run: 0, number: 0 };
        let sender = sender.clone();
        session
            .get(space.of_order(order))
            .payload(payload)
            .attachment(encode(&stamp))
            .consolidation(ConsolidationMode::None)
            .timeout(DONE)
            .callback(move |reply| {
                let outcome = match reply.result() {
                    Ok(sample) => outcome(sample),
                    Err(_) => Outcome::refused(format!("no answer within {} s", DONE.as_secs())),
                };
                // Fails if nobody waits any more.
                let _ = sender.send((index, outcome));
            })
            .wait()?;
    }
    drop(sender);
    let mut has_answered = vec![false; skins.len()];
    while !is_over() {
        match answers.recv_timeout(LOOK) {
            Ok((index, outcome)) => {
                has_answered[index] = true;
                tell(&skins[index], outcome);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    let why = if is_over() {
        "stopped before it answered: it may be done all the same"
    } else {
        "no answer: it has gone, or its computer's program is an older one"
    };
    for (space, _) in skins.iter().zip(has_answered).filter(|(_, has_answered)| !has_answered) {
        tell(space, Outcome::refused(why));
    }
    Ok(())
}

fn outcome(sample: &Sample) -> Outcome {
    let attachment = sample.attachment().map(|bytes| bytes.to_bytes()).unwrap_or_default();
    let read = message::stamp(&attachment).and_then(|_| decode(&payload(sample.payload())?));
    read.unwrap_or_else(|error| Outcome::refused(format!("the answer is not read: {error}")))
}

fn payload(bytes: &ZBytes) -> Result<Vec<u8>, DecodeError> {
    if bytes.len() > MOST_BYTES {
        Err(DecodeError::Damaged(bytes.len()))
    } else {
        Ok(bytes.to_bytes().into())
    }
}

/// The skins of these names, or all, once they are there and each is served by one program.
fn skins(
    session: &Session,
    robot: &str,
    patches: &[String],
    is_over: &impl Fn() -> bool,
) -> Result<Vec<Space>, ZenohError> {
    let begun = Instant::now();
    let (mut there, mut changed) = (BTreeMap::new(), begun);
    while !is_over() {
        let now = alive(session, Some(robot))?;
        if now != there {
            (there, changed) = (now, Instant::now());
        }
        let is_there = |name: &String| there.keys().any(|space| space.patch == *name);
        let is_named = if patches.is_empty() { !there.is_empty() } else { patches.iter().all(is_there) };
        // Another one may be found a little later, also one that claims the same skin.
        let is_quiet = changed.elapsed() >= ALL_FOUND || begun.elapsed() >= FOUND;
        let meant = || there.iter().filter(|(space, _)| patches.is_empty() || patches.contains(&space.patch));
        // A program that has just been started anew is not alone before its predecessor is known to be gone.
        let claimed = meant().find(|(_, runs)| runs.len() > 1);
        if is_named && is_quiet && claimed.is_none() {
            return Ok(meant().map(|(space, _)| space.clone()).collect());
        }
        if begun.elapsed() >= FOUND {
            if let Some(missing) = patches.iter().find(|name| !is_there(name)) {
                let mut known: Vec<_> = there.keys().map(|space| format!("`{}`", space.patch)).collect();
                known.dedup();
                return Err(ZenohError::Patch {
                    robot: robot.to_owned(),
                    patch: missing.clone(),
                    known: known.join(", "),
                });
            }
            let Some((space, runs)) = claimed else { break };
            return Err(ZenohError::Claimed { space: space.clone().into(), count: runs.len() });
        }
        thread::sleep(LOOK);
    }
    Ok(Vec::new())
}
