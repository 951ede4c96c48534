//! Robot: the skins of one computer, told to all others.

use crate::{
    key::Space,
    message::Skin,
    outlet::{Outlet, Server},
    settings::{Settings, ZenohError},
};
use dermatome_body::{
    Body, Sense,
    file::{BodyFile, Patch},
    keeper::{Asked, Told},
};
use dermatome_messages::clock::now_ns;
use std::time::{Duration, Instant};
use zenoh::{Session, Wait};

/// How often states are told again: by this, others know that this computer goes on.
pub(crate) const PULSE: Duration = Duration::from_millis(500);

/// The skins that this computer serves.
pub struct Robot {
    session: Session,
    /// `[patch]`
    outlets: Vec<Outlet>,
    skins: Vec<Skin>,
    told: Instant,
}

impl Robot {
    /// Opens the skins of a body file, whose skin files hold these texts, to the network, where others may tare and drive them
    /// if it takes orders.
    pub fn start(
        file: &BodyFile,
        texts: &[String],
        settings: &Settings,
        takes_orders: bool,
    ) -> Result<Self, ZenohError> {
        let session = settings.open()?;
        let skins: Vec<Skin> =
            file.patches.iter().zip(texts).map(|(patch, text)| skin(patch, text)).collect();
        let server = Server { computer: computer(), run: run(&session) };
        let open = |(patch, skin): (&Patch, &Skin)| {
            Outlet::open(&session, &space(&file.name, patch), &server, skin, takes_orders)
        };
        let outlets = file.patches.iter().zip(&skins).map(open).collect::<Result<_, _>>()?;
        Ok(Self { session, outlets, skins, told: Instant::now() })
    }

    /// Tells what the keeper of a patch, by its place in the body file, told after the body has taken it.
    pub fn tell(&mut self, body: &Body, index: usize, told: &Told) {
        let (Some(sense), Some(outlet)) = (body.senses().get(index), self.outlets.get_mut(index)) else {
            return;
        };
        if let (Told::Patch { .. }, Some(skin)) = (told, self.skins.get_mut(index)) {
            skin.centres = centres(sense);
            outlet.show(skin);
        }
        outlet.tell(sense, told);
    }

    /// Tells all states again where it is time; gives what keepers are asked to do, by their patches.
    pub fn attend(&mut self, body: &Body) -> Vec<(usize, Asked)> {
        let is_time = self.told.elapsed() >= PULSE;
        if is_time {
            self.told = Instant::now();
        }
        let mut wanted = Vec::new();
        for (index, (outlet, sense)) in self.outlets.iter_mut().zip(body.senses()).enumerate() {
            if is_time {
                outlet.stand(sense);
            }
            wanted.extend(outlet.requests(sense).into_iter().map(|asked| (index, asked)));
        }
        wanted
    }

    /// Leaves the network: others know at once.
    pub fn end(self) {
        drop(self.outlets);
        if let Err(error) = self.session.close().wait() {
            log::debug!("Zenoh does not close: {error}");
        }
    }
}

fn space(robot: &str, patch: &Patch) -> Space {
    Space { robot: robot.to_owned(), link: patch.pose.link.clone(), patch: patch.name.clone() }
}

fn skin(patch: &Patch, file: &str) -> Skin {
    let (position, orientation) = (patch.pose.position, patch.pose.orientation);
    Skin { file: file.to_owned(), position, orientation, centres: Vec::new() }
}

fn centres(sense: &Sense) -> Vec<[f32; 3]> {
    let placed = sense.placed().map(|placed| placed.centres.as_slice()).unwrap_or_default();
    placed.iter().map(|centre| centre.map(|value| value as f32)).collect()
}

/// A number that no other run of the program has, also where it is told which id to have.
fn run(session: &Session) -> u64 {
    let id = session.info().zid().wait().to_le_bytes();
    id.iter().fold(now_ns(), |run, byte| run.rotate_left(8) ^ u64::from(*byte))
}

fn computer() -> String {
    sysinfo::System::host_name().unwrap_or_else(|| "a computer without a name".to_owned())
}
