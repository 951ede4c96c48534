//! Robot: a body's skins and what they share.

use crate::{
    message,
    names::{part, same},
    node::{LASTING, Publishers, RELIABLE, RosError, SENSOR_DATA, publish},
    settings::Settings,
    skin::Skin,
};
use dermatome_body::{
    Body,
    file::BodyFile,
    keeper::{Asked, Told},
};
use dermatome_messages::{
    clock::now_ns,
    standard::{DiagnosticArray, Header, TfMessage, Time, WrenchStamped},
};
use ros2_client::{Node, Publisher};
use std::time::{Duration, Instant};

/// How often diagnostics are told.
const DIAGNOSED: Duration = Duration::from_secs(1);
/// How often services are looked after.
const ATTENDED: Duration = Duration::from_millis(10);

/// A robot's skins as a node of ROS.
pub struct Robot {
    name: String,
    /// `[patch]`.
    skins: Vec<Skin>,
    /// Where their boards are: `[patch]`.
    ports: Vec<String>,
    links: Vec<Link>,
    diagnostics: Publisher<DiagnosticArray>,
    diagnosed: Instant,
    attended: Instant,
    /// Holds the last message for those who come later.
    _transforms: Publisher<TfMessage>,
    _node: Node,
}

struct Link {
    name: String,
    wrench: Publisher<WrenchStamped>,
    is_known: bool,
}

impl Robot {
    /// Makes the node `/ROBOT/dermatome`, and tells where the skins lie.
    pub fn start(file: &BodyFile, settings: Settings) -> Result<Self, RosError> {
        let mut links: Vec<&str> = file.patches.iter().map(|patch| patch.pose.link.as_str()).collect();
        links.sort_unstable();
        links.dedup();
        let skins: Vec<&str> = file.patches.iter().map(|patch| patch.name.as_str()).collect();
        if let Some([a, b]) = same(&links).or_else(|| same(&skins)) {
            return Err(RosError::Name(format!("`{a}` and `{b}` are both `{}` there", part(a))));
        }
        let mut publishers = Publishers::start(&part(&file.name), settings)?;
        let transforms = publishers.make("/tf_static", "tf2_msgs/TFMessage", LASTING)?;
        publish(&transforms, message::transforms(file, now_ns()));
        let diagnostics = publishers.make("/diagnostics", "diagnostic_msgs/DiagnosticArray", RELIABLE)?;
        let skins = skins.iter().map(|skin| Skin::start(&mut publishers, file, skin, settings));
        let skins = skins.collect::<Result<_, _>>()?;
        let links = links.iter().map(|link| {
            let topic = format!("/{}/{}/wrench", part(&file.name), part(link));
            let wrench = publishers.make(&topic, "geometry_msgs/WrenchStamped", SENSOR_DATA)?;
            Ok(Link { name: (*link).to_owned(), wrench, is_known: false })
        });
        let links = links.collect::<Result<_, RosError>>()?;
        Ok(Self {
            name: file.name.clone(),
            skins,
            ports: file.patches.iter().map(|patch| patch.port.to_string()).collect(),
            links,
            diagnostics,
            diagnosed: Instant::now(),
            attended: Instant::now(),
            _transforms: transforms,
            _node: publishers.node,
        })
    }

    /// Publishes what the keeper of a patch told, after the body has taken it.
    pub fn tell(&mut self, body: &Body, index: usize, told: &Told) {
        let (Some(sense), Some(skin)) = (body.senses().get(index), self.skins.get_mut(index)) else { return };
        if !skin.tell(sense, told) {
            return;
        }
        let Some(link) = self.links.iter_mut().find(|link| link.name == sense.link) else { return };
        let wrench = body.wrench(&link.name);
        // Once more than it is known, so that none stays that is over.
        if wrench.is_some() || link.is_known {
            let time_ns = sense.report.as_ref().map_or_else(now_ns, |report| report.time_ns);
            publish(&link.wrench, message::link_wrench(&link.name, wrench, time_ns));
        }
        link.is_known = wrench.is_some();
    }

    /// Tells diagnostics once a second; gives what services have asked keepers for, by their patches.
    pub fn attend(&mut self, body: &Body) -> Vec<(usize, Asked)> {
        if self.attended.elapsed() < ATTENDED {
            return Vec::new();
        }
        self.attended = Instant::now();
        if self.diagnosed.elapsed() >= DIAGNOSED {
            self.diagnosed = Instant::now();
            self.diagnose(body);
        }
        let each = self.skins.iter_mut().zip(body.senses()).enumerate();
        each.flat_map(|(index, (skin, sense))| {
            skin.requests(sense).into_iter().map(move |asked| (index, asked))
        })
        .collect()
    }

    /// Tells that all contacts are over, at the end.
    pub fn end(&mut self, body: &Body) {
        for (skin, sense) in self.skins.iter_mut().zip(body.senses()) {
            skin.end(sense);
        }
        for link in self.links.iter().filter(|link| link.is_known) {
            publish(&link.wrench, message::link_wrench(&link.name, None, now_ns()));
        }
    }

    fn diagnose(&mut self, body: &Body) {
        let each = self.skins.iter_mut().zip(&self.ports).zip(body.senses());
        let status = each
            .map(|((skin, port), sense)| {
                message::status(&self.name, port.clone(), sense, skin.take_problems())
            })
            .collect();
        let header = Header { stamp: Time::of_nanoseconds(now_ns()), frame_id: String::new() };
        publish(&self.diagnostics, DiagnosticArray { header, status });
    }
}
