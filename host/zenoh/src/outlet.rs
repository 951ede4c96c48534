//! Outlet: what one skin tells, and answers when it is asked.

use crate::{
    asking::Desk,
    key::{Space, Topic},
    message::{Contacts, Health, Image, Stamp, State, Tare, Version, encode, shortened},
    settings::ZenohError,
};
use dermatome_body::{
    Report, Sense,
    keeper::{Asked, Told},
};
use dermatome_link::ScanFrame;
use dermatome_messages::clock::now_ns;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use zenoh::{
    Session, Wait,
    key_expr::KeyExpr,
    liveliness::LivelinessToken,
    pubsub::Publisher,
    qos::{CongestionControl, Priority},
    query::{Query, Queryable},
};

/// Least time between two images, ns: 30 a second are enough to look at.
const PERIOD: u64 = 1_000_000_000 / 30;

/// Who serves: name of the computer, and which run of the program.
#[derive(Clone, Debug)]
pub(crate) struct Server {
    pub(crate) computer: String,
    pub(crate) run: u64,
}

/// A skin on the network.
pub(crate) struct Outlet {
    server: Server,
    contacts: Counted,
    image: Counted,
    health: Counted,
    state: Counted,
    answers: Arc<Mutex<Answers>>,
    desk: Desk,
    /// When an image was told last, ns since 1970.
    drawn: u64,
    _queryable: Queryable<()>,
    _alive: LivelinessToken,
}

/// A publisher that numbers what it tells.
struct Counted {
    publisher: Publisher<'static>,
    run: u64,
    number: u64,
}

/// What those are told who ask, as messages.
#[derive(Clone, Default)]
struct Answers {
    state: Option<Vec<u8>>,
    skin: Vec<u8>,
    tare: Option<Vec<u8>>,
}

impl Counted {
    /// What finds no room on its way is dropped, so that nobody who is slow holds up this computer; what is urgent goes
    /// ahead of all else.
    fn declare(session: &Session, key: String, run: u64, is_urgent: bool) -> Result<Self, ZenohError> {
        let priority = if is_urgent { Priority::InteractiveHigh } else { Priority::DataLow };
        let publisher = session
            .declare_publisher(key)
            .congestion_control(CongestionControl::Drop)
            .priority(priority)
            .wait()?;
        Ok(Self { publisher, run, number: 0 })
    }

    fn put(&mut self, message: Vec<u8>) {
        self.number += 1;
        let stamp = Stamp { version: Version::OURS, run: self.run, number: self.number };
        if let Err(error) = self.publisher.put(message).attachment(encode(&stamp)).wait() {
            log::debug!("`{}` is not published: {error}", self.publisher.key_expr());
        }
    }
}

impl Outlet {
    pub(crate) fn open(
        session: &Session,
        space: &Space,
        server: &Server,
        skin: &crate::message::Skin,
        takes_orders: bool,
    ) -> Result<Self, ZenohError> {
        let run = server.run;
        let declare = |topic, is_urgent| Counted::declare(session, space.of(topic), run, is_urgent);
        let answers = Arc::new(Mutex::new(Answers { skin: encode(skin), ..Answers::default() }));
        let (asked, keys) = (answers.clone(), Keys::of(space)?);
        let queryable = session
            .declare_queryable(space.of_queries())
            .callback(move |query| {
                // Whoever asks may be slow: nobody waits for the answers meanwhile.
                let answers = held(&asked).clone();
                keys.answer(&query, &answers, run);
            })
            .wait()?;
        Ok(Self {
            server: server.clone(),
            contacts: declare(Topic::Contacts, true)?,
            image: declare(Topic::Image, false)?,
            health: declare(Topic::Health, false)?,
            state: declare(Topic::State, true)?,
            answers,
            desk: Desk::open(session, space, run, takes_orders)?,
            drawn: 0,
            _queryable: queryable,
            // Last, as it says that all else is there.
            _alive: session.liveliness().declare_token(space.alive(run)).wait()?,
        })
    }

    /// Tells what came.
    pub(crate) fn tell(&mut self, sense: &Sense, told: &Told) {
        self.desk.hear(told);
        match told {
            Told::State(_) => self.stand(sense),
            Told::Reference(reference) => {
                held(&self.answers).tare = Some(encode(&Tare::from(&**reference)));
            }
            Told::Frame { frame, .. } => {
                self.health(frame);
                if let Some(report) = sense.report.as_ref().filter(|report| frame.at == Some(report.at)) {
                    self.frame(report, sense.missing);
                }
            }
            Told::Patch { .. } | Told::Driven(_) | Told::NotDriven { .. } | Told::GivenUp(_) => {}
        }
    }

    /// What its keeper is asked to do.
    pub(crate) fn requests(&mut self, sense: &Sense) -> Vec<Asked> {
        self.desk.requests(sense)
    }

    /// Whoever asks for the skin gets this one from now on.
    pub(crate) fn show(&self, skin: &crate::message::Skin) {
        held(&self.answers).skin = encode(skin);
    }

    /// Tells how the board stands.
    pub(crate) fn stand(&mut self, sense: &Sense) {
        let state = encode(&State {
            computer: self.server.computer.clone(),
            phase: sense.state.phase,
            text: shortened(&sense.state.text),
            frames: sense.frames,
            missing: sense.missing,
            losses: sense.losses,
        });
        held(&self.answers).state = Some(state.clone());
        self.state.put(state);
    }

    fn frame(&mut self, report: &Report, missing: u64) {
        self.contacts.put(encode(&Contacts::new(report, missing)));
        let Some(image) = &report.image else { return };
        if report.received_ns.saturating_sub(self.drawn) >= PERIOD {
            self.drawn = report.received_ns;
            let image = Image { at: report.at, ended_ns: report.time_ns, image: image.clone() };
            self.image.put(encode(&image));
        }
    }

    fn health(&mut self, frame: &ScanFrame) {
        let (Some(at), Some(report)) = (frame.at, frame.health.clone()) else { return };
        let dermatome_link::assemble::HealthReport { health, vitals, drift, missed } = report;
        self.health.put(encode(&Health { at, health, vitals, drift, missed }));
    }
}

fn held(answers: &Mutex<Answers>) -> MutexGuard<'_, Answers> {
    answers.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keys of what a skin may be asked for.
struct Keys {
    state: KeyExpr<'static>,
    skin: KeyExpr<'static>,
    tare: KeyExpr<'static>,
    clock: KeyExpr<'static>,
}

impl Keys {
    fn of(space: &Space) -> Result<Self, ZenohError> {
        let key = |topic| Ok::<_, ZenohError>(KeyExpr::try_from(space.of(topic))?);
        Ok(Self {
            state: key(Topic::State)?,
            skin: key(Topic::Skin)?,
            tare: key(Topic::Tare)?,
            clock: key(Topic::Clock)?,
        })
    }

    fn answer(&self, query: &Query, answers: &Answers, run: u64) {
        let reply = |key: &KeyExpr<'static>, message: Vec<u8>| {
            if !query.key_expr().intersects(key) {
                return;
            }
            let stamp = Stamp { version: Version::OURS, run, number: 0 };
            if let Err(error) = query.reply(key, message).attachment(encode(&stamp)).wait() {
                log::debug!("`{key}` is not answered: {error}");
            }
        };
        reply(&self.clock, encode(&now_ns()));
        reply(&self.skin, answers.skin.clone());
        for (key, answer) in [(&self.state, &answers.state), (&self.tare, &answers.tare)] {
            if let Some(answer) = answer {
                reply(key, answer.clone());
            }
        }
    }
}
