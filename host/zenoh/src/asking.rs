//! Asking: what skins are asked to do over the network, by who asks and by who does it.

use crate::{
    key::{Order, Space, all_alive},
    listener::{ANSWERED, LOOK, find},
    message::{self, DecodeError, MOST_BYTES, Stamp, Version, decode, encode, shortened},
    settings::{Settings, ZenohError},
};
use dermatome_body::{
    Sense,
    asking::{Asked, Outcome, Waiting},
    keeper::Told,
};
use dermatome_messages::dermatome::DriveRequest;
use std::{
    collections::BTreeSet,
    sync::mpsc::{Receiver, RecvTimeoutError, TrySendError, channel, sync_channel},
    time::{Duration, Instant},
};
use zenoh::{
    Session, Wait,
    bytes::ZBytes,
    key_expr::KeyExpr,
    query::{ConsolidationMode, Query, Queryable},
    sample::Sample,
};

/// Most requests to one skin that are not answered yet.
const MOST_WAITING: usize = 32;
/// Until skins are there that somebody asks for.
const FOUND: Duration = Duration::from_secs(5);
/// How long no other skin must have come for all to be there.
const ALL_FOUND: Duration = Duration::from_secs(1);
/// Longest that anything takes which is asked for: a reference of the slowest frames.
const DONE: Duration = Duration::from_secs(300);

/// Takes what one skin is asked for, and answers when it is done.
pub(crate) struct Desk {
    run: u64,
    /// Keys of what it may be asked for.
    tare: KeyExpr<'static>,
    drive: KeyExpr<'static>,
    /// Whether it does what it is asked for.
    is_allowed: bool,
    asked: Receiver<Query>,
    waiting: Waiting<Query>,
    _queryable: Queryable<()>,
}

impl Desk {
    pub(crate) fn open(
        session: &Session,
        space: &Space,
        run: u64,
        is_allowed: bool,
    ) -> Result<Self, ZenohError> {
        let key = |order| Ok::<_, ZenohError>(KeyExpr::try_from(space.of_order(order))?);
        let (sender, asked) = sync_channel(MOST_WAITING);
        let queryable = session
            .declare_queryable(space.of_orders())
            .callback(move |query| {
                // More than that is not looked at, and who asks is told that nobody answered.
                if let Err(TrySendError::Full(_)) = sender.try_send(query) {
                    log::debug!("more is asked at once than is looked at");
                }
            })
            .wait()?;
        let (tare, drive) = (key(Order::Tare)?, key(Order::Drive)?);
        Ok(Self { run, tare, drive, is_allowed, asked, waiting: Waiting::default(), _queryable: queryable })
    }

    /// Takes what has been asked for; what cannot be done is answered.
    pub(crate) fn requests(&mut self, sense: &Sense) -> Vec<Asked> {
        let mut wanted = Vec::new();
        while let Ok(query) = self.asked.try_recv() {
            match self.decide(&query, sense) {
                Ok(asked) => {
                    self.waiting.add(query, &asked);
                    wanted.push(asked);
                }
                Err(outcome) => self.answer(&query, &outcome),
            }
        }
        wanted
    }

    /// Answers the requests that this decides.
    pub(crate) fn hear(&mut self, told: &Told) {
        let mut answers = Vec::new();
        self.waiting.hear(told, |query, outcome| answers.push((query.clone(), outcome)));
        answers.into_iter().for_each(|(query, outcome)| self.answer(&query, &outcome));
    }

    fn decide(&self, query: &Query, sense: &Sense) -> Result<Asked, Outcome> {
        if !self.is_allowed {
            return Err(Outcome::refused(
                "its computer takes no orders: start `dermatome serve` there with `--zenoh-orders`",
            ));
        }
        if self.waiting.len() >= MOST_WAITING {
            return Err(Outcome::refused("too much is asked at once"));
        }
        let unreadable = |error: DecodeError| Outcome::refused(format!("the request is not read: {error}"));
        if let Some(stamp) = query.attachment() {
            message::stamp(&stamp.to_bytes()).map_err(unreadable)?;
        }
        match self.order(query) {
            Some(Order::Tare) => Asked::tare(sense),
            Some(Order::Drive) => {
                let payload = query.payload().map(payload).transpose().map_err(unreadable)?;
                Asked::drive(&decode(&payload.unwrap_or_default()).map_err(unreadable)?, sense)
            }
            None => Err(Outcome::refused("allowed: `tare` or `drive`, one of them")),
        }
    }

    /// What a query, whose key may stand for several, asks for.
    fn order(&self, query: &Query) -> Option<Order> {
        let asks = |key: &KeyExpr<'static>| query.key_expr().intersects(key);
        match (asks(&self.tare), asks(&self.drive)) {
            (true, false) => Some(Order::Tare),
            (false, true) => Some(Order::Drive),
            _ => None,
        }
    }

    fn answer(&self, query: &Query, outcome: &Outcome) {
        let key = if self.order(query) == Some(Order::Drive) { &self.drive } else { &self.tare };
        let stamp = Stamp { version: Version::OURS, run: self.run, number: 0 };
        let outcome = Outcome { message: shortened(&outcome.message), success: outcome.success };
        if let Err(error) = query.reply(key, encode(&outcome)).attachment(encode(&stamp)).wait() {
            log::debug!("`{key}` is not answered: {error}");
        }
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
        None => find(&session, &is_over)?,
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
                    Err(error) => Outcome::refused(String::from_utf8_lossy(&error.payload().to_bytes())),
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
    for (space, _) in skins.iter().zip(has_answered).filter(|(_, has_answered)| !has_answered) {
        tell(space, Outcome::refused("no answer: it has gone, or its computer's program is an older one"));
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

/// The skins of these names, or all, once they are there.
fn skins(
    session: &Session,
    robot: &str,
    patches: &[String],
    is_over: &impl Fn() -> bool,
) -> Result<Vec<Space>, ZenohError> {
    let begun = Instant::now();
    let (mut there, mut changed) = (BTreeSet::new(), begun);
    while !is_over() {
        let now = alive(session, robot)?;
        if now != there {
            (there, changed) = (now, Instant::now());
        }
        let is_there = |name: &String| there.iter().any(|space| space.patch == *name);
        let is_all = !there.is_empty() && changed.elapsed() >= ALL_FOUND;
        let is_enough = if patches.is_empty() { is_all } else { patches.iter().all(is_there) };
        if is_enough {
            let is_meant = |space: &Space| patches.is_empty() || patches.contains(&space.patch);
            return Ok(there.into_iter().filter(is_meant).collect());
        }
        if begun.elapsed() >= FOUND {
            let missing = patches.iter().find(|name| !is_there(name)).map_or("", String::as_str);
            let mut known: Vec<_> = there.iter().map(|space| format!("`{}`", space.patch)).collect();
            known.dedup();
            return Err(ZenohError::Patch {
                robot: robot.to_owned(),
                patch: missing.to_owned(),
                known: known.join(", "),
            });
        }
        std::thread::sleep(LOOK);
    }
    Ok(Vec::new())
}

/// The skins of a robot that are served now.
fn alive(session: &Session, robot: &str) -> Result<BTreeSet<Space>, ZenohError> {
    let replies = session.liveliness().get(all_alive(Some(robot))).timeout(ANSWERED).wait()?;
    let mut there = BTreeSet::new();
    while let Ok(reply) = replies.recv() {
        let key = reply.result().ok().map(|sample| sample.key_expr().as_str().to_owned());
        there.extend(key.and_then(|key| Space::of_alive(&key)).map(|(space, _)| space));
    }
    Ok(there)
}
