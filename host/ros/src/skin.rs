//! Skin: what one skin publishes under `/ROBOT/SKIN`.

use crate::{
    message,
    names::part,
    node::{Publishers, RosError, SENSOR_DATA, publish},
    service::Services,
    settings::Settings,
};
use dermatome_body::{
    Report, Sense,
    file::BodyFile,
    keeper::{Asked, Phase, Told},
};
use dermatome_messages::{
    clock::now_ns,
    dermatome::SkinContactArray,
    frame::Place,
    scene::Scene,
    standard::{MarkerArray, PointCloud2},
};
use dermatome_shared::{frame::FrameFlags, protocol::FrameStamp};
use ros2_client::Publisher;

/// Least time between two images or drawings, ns: 30 a second are enough to look at.
const PERIOD: u64 = 1_000_000_000 / 30;

/// A skin of a robot.
pub(crate) struct Skin {
    contacts: Publisher<SkinContactArray>,
    pressure: Publisher<PointCloud2>,
    markers: Publisher<MarkerArray>,
    services: Services,
    /// Made when the patch is known.
    scene: Option<Scene>,
    /// When the last drawing was published, ns since 1970.
    drawn: u64,
    is_live: bool,
    /// The frame whose contacts were published last.
    last: Option<FrameStamp>,
    /// Of frames since the last diagnostics.
    flags: FrameFlags,
    /// Reflexes that were tripped since then, a bit for each.
    tripped: u8,
}

impl Skin {
    pub(crate) fn start(
        publishers: &mut Publishers,
        file: &BodyFile,
        skin: &str,
        settings: Settings,
    ) -> Result<Self, RosError> {
        let space = format!("/{}/{}", part(&file.name), part(skin));
        let topic = |name| format!("{space}/{name}");
        Ok(Self {
            contacts: publishers.make(&topic("contacts"), "dermatome_msgs/SkinContactArray", SENSOR_DATA)?,
            pressure: publishers.make(&topic("pressure"), "sensor_msgs/PointCloud2", SENSOR_DATA)?,
            markers: publishers.make(&topic("markers"), "visualization_msgs/MarkerArray", SENSOR_DATA)?,
            services: Services::start(&mut publishers.node, &space, settings.mapping)?,
            scene: None,
            drawn: 0,
            is_live: false,
            last: None,
            flags: FrameFlags::default(),
            tripped: 0,
        })
    }

    /// Publishes what came; whether it changes what presses on the link.
    pub(crate) fn tell(&mut self, sense: &Sense, told: &Told) -> bool {
        let has_told = match told {
            Told::Frame { .. } => match &sense.report {
                // A frame that came without contacts leaves the report before.
                Some(report) if self.last.replace(report.at) != Some(report.at) => {
                    self.frame(sense, report);
                    true
                }
                _ => false,
            },
            Told::Patch { .. } => {
                self.scene = scene(sense);
                false
            }
            Told::State(state) => {
                let is_live = state.phase == Phase::Live;
                let is_over = !is_live && self.end(sense);
                self.is_live = is_live;
                is_over
            }
            Told::Driven(_) | Told::NotDriven { .. } | Told::GivenUp(_) | Told::Reference(_) => false,
        };
        self.services.hear(told);
        has_told
    }

    /// What services ask its keeper for.
    pub(crate) fn requests(&mut self, sense: &Sense) -> Vec<Asked> {
        self.services.requests(sense)
    }

    /// What was wrong with its frames, and which reflexes were tripped, since this was asked last.
    pub(crate) fn take_problems(&mut self) -> (FrameFlags, u8) {
        (std::mem::take(&mut self.flags), std::mem::take(&mut self.tripped))
    }

    fn frame(&mut self, sense: &Sense, report: &Report) {
        self.flags.insert(report.at.flags);
        self.tripped |= sense.reflexes.as_ref().map_or(0, |reflexes| reflexes.tripped);
        publish(&self.contacts, message::contacts(sense, report));
        let Some(scene) = &self.scene else { return };
        if report.received_ns.saturating_sub(self.drawn) < PERIOD {
            return;
        }
        self.drawn = report.received_ns;
        if let Some(image) = &report.image {
            publish(&self.pressure, scene.cloud(image, report.time_ns));
        }
        let contacts = report.contacts.iter().map(|contact| contact.contact);
        publish(&self.markers, scene.markers(contacts, report.time_ns));
    }

    /// Tells that what it said before is over; whether it had said anything.
    pub(crate) fn end(&mut self, sense: &Sense) -> bool {
        if !std::mem::take(&mut self.is_live) {
            return false;
        }
        let now = now_ns();
        publish(&self.contacts, message::no_contacts(sense, now));
        if let Some(scene) = &self.scene {
            publish(&self.pressure, scene.no_cloud(now));
            publish(&self.markers, scene.markers([], now));
        }
        true
    }
}

fn scene(sense: &Sense) -> Option<Scene> {
    let placed = sense.placed()?;
    let centres = placed.centres.iter().map(|centre| centre.map(|value| value as f32)).collect();
    Some(Scene::new(sense.name.clone(), Place::of(&sense.name, Some(&placed.pose)), centres, String::new()))
}
