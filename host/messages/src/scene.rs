//! Scene: frames as messages that other programs draw without knowing a skin.

use crate::{
    cdr,
    frame::Place,
    standard::{
        Color, DiagnosticArray, DiagnosticStatus, KeyValue, Marker, MarkerArray, Point, PointCloud2,
        PointField, Pose as RosPose, Quaternion, TfMessage, TransformStamped,
    },
    topic::{Packed, Topic},
};
use dermatome_link::{ScanFrame, assemble::HealthReport, pose::Pose};
use dermatome_shared::{contact::Contact, frame::FrameFlags, health::ElectrodeSet, protocol::PackedImage};
use std::f32::consts::FRAC_1_PI;

/// Least time between two scenes, ns: 30 a second are enough to look at.
const PERIOD: u64 = 1_000_000_000 / 30;
/// Least time between two diagnostics, ns.
const DIAGNOSTICS_PERIOD: u64 = 1_000_000_000;
/// Of a point of a cloud: x, y, z and intensity.
const BYTES_OF_POINT: u32 = 16;
/// Level of a diagnostic where something is to be looked at.
pub const WARN: u8 = 1;
/// Level of a diagnostic where nothing is to be had of a skin.
pub const ERROR: u8 = 2;
/// Length of the arrow of a contact of strength 1, as a part of the skin's size.
const ARROW: f64 = 0.5;

/// Makes scenes of frames, not more often than one looks at them.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Of the skin, among others of a robot.
    name: String,
    place: Place,
    /// m: `[pixel][x, y, z]`.
    centres: Vec<[f32; 3]>,
    /// m
    size: f64,
    board: String,
    drawn: u64,
    diagnosed: u64,
    flags: FrameFlags,
    /// Rules that were tripped: a bit for each.
    tripped: u8,
}

impl Scene {
    /// Of a skin of this name with these centres of its pixels, m, in the frame of its place, at a board that is called so.
    #[must_use]
    pub fn new(name: String, place: Place, centres: Vec<[f32; 3]>, board: String) -> Self {
        let extent = |axis: usize| {
            let along = centres.iter().map(|centre| f64::from(centre[axis]));
            let low = along.clone().fold(f64::INFINITY, f64::min);
            along.fold(f64::NEG_INFINITY, f64::max) - low
        };
        let size = (0..3).map(extent).fold(0.0, f64::max);
        let flags = FrameFlags::default();
        Self { name, place, centres, size, board, drawn: 0, diagnosed: 0, flags, tripped: 0 }
    }

    /// The scene of a frame, if the last one is old enough.
    pub fn messages(&mut self, frame: &ScanFrame, now_ns: u64) -> Vec<Packed> {
        let mut packed = Vec::new();
        let Some(at) = frame.at else { return packed };
        let mut put = |topic, bytes| packed.push(Packed::now(topic, now_ns, bytes));
        self.flags.insert(at.flags);
        self.tripped |= frame.reflexes.as_ref().map_or(0, |reflexes| reflexes.tripped);
        // One without contacts is no sign that all is well.
        let tells = frame.contacts.is_some() || !self.problems(frame).is_empty();
        if tells && now_ns.saturating_sub(self.diagnosed) >= DIAGNOSTICS_PERIOD {
            self.diagnosed = now_ns;
            put(Topic::Diagnostics, cdr::encode(&self.diagnostics(frame, now_ns)));
            (self.flags, self.tripped) = (FrameFlags::default(), 0);
        }
        let Some(contacts) = &frame.contacts else { return packed };
        if now_ns.saturating_sub(self.drawn) < PERIOD {
            return packed;
        }
        self.drawn = now_ns;
        let on_link = contacts.iter().map(|contact| self.place.contact(contact));
        put(Topic::Markers, cdr::encode(&self.markers(on_link, now_ns)));
        if let Some(image) = &frame.image {
            put(Topic::Pressure, cdr::encode(&self.cloud(image, now_ns)));
        }
        packed
    }

    /// The scene once what the board said is over, why, and a diagnostic's level: no contacts and no image.
    pub fn over(&mut self, level: u8, why: &str, now_ns: u64) -> Vec<Packed> {
        (self.drawn, self.diagnosed) = (0, now_ns);
        let status = DiagnosticStatus { level, ..self.diagnostic(why.to_owned(), Vec::new()) };
        let diagnostics = DiagnosticArray { header: self.place.header(now_ns), status: vec![status] };
        let messages = [
            (Topic::Markers, cdr::encode(&self.markers([], now_ns))),
            (Topic::Pressure, cdr::encode(&self.no_cloud(now_ns))),
            (Topic::Diagnostics, cdr::encode(&diagnostics)),
        ];
        messages.map(|(topic, bytes)| Packed::now(topic, now_ns, bytes)).to_vec()
    }

    /// An image as points x, y, z (m) and `intensity`, by which other programs colour them: relative change of conductivity.
    #[must_use]
    pub fn cloud(&self, image: &PackedImage, time_ns: u64) -> PointCloud2 {
        let numbers = self.centres.iter().zip(image.values()).flat_map(|(centre, value)| {
            let [x, y, z] = *centre;
            [x, y, z, value as f32]
        });
        self.cloud_of(numbers.flat_map(f32::to_le_bytes).collect(), time_ns)
    }

    /// Of no image: without a point.
    #[must_use]
    pub fn no_cloud(&self, time_ns: u64) -> PointCloud2 {
        self.cloud_of(Vec::new(), time_ns)
    }

    fn cloud_of(&self, data: Vec<u8>, time_ns: u64) -> PointCloud2 {
        let field = |(name, place): (&str, u32)| PointField {
            name: name.to_owned(),
            offset: 4 * place,
            datatype: 7,
            count: 1,
        };
        let width = data.len() as u32 / BYTES_OF_POINT;
        PointCloud2 {
            header: self.place.header(time_ns),
            height: 1,
            width,
            fields: ["x", "y", "z", "intensity"].into_iter().zip(0..).map(field).collect(),
            is_bigendian: false,
            point_step: BYTES_OF_POINT,
            row_step: BYTES_OF_POINT * width,
            data,
            is_dense: true,
        }
    }

    /// Contacts in the frame of the place, each a sphere as large as it, an arrow along its normal and a text.
    #[must_use]
    pub fn markers(&self, contacts: impl IntoIterator<Item = Contact>, time_ns: u64) -> MarkerArray {
        let header = self.place.header(time_ns);
        let marker = |ns: &str, id: usize, kind: i32| Marker {
            header: header.clone(),
            ns: ns.to_owned(),
            id: id as i32,
            kind,
            pose: RosPose::default(),
            color: Color { r: 0.9, g: 0.35, b: 0.1, a: 0.8 },
            frame_locked: true,
            ..Marker::default()
        };
        // Of all names: an empty one.
        let clear = Marker { action: 3, ..marker("", 0, 2) };
        let drawn = contacts.into_iter().enumerate().flat_map(|(id, contact)| {
            let radius = f64::from((contact.area * FRAC_1_PI).sqrt());
            let position: Point = contact.position.into();
            let length = ARROW * self.size * f64::from(contact.strength.clamp(0.0, 1.0));
            let tip = [0, 1, 2]
                .map(|axis| f64::from(contact.position[axis]) + length * f64::from(contact.normal[axis]));
            let sphere = Marker {
                pose: RosPose { position, ..RosPose::default() },
                scale: [2.0 * radius; 3].into(),
                ..marker("contacts", id, 2)
            };
            // An arrow points at the skin: from outside to where it is pressed.
            let arrow = Marker {
                points: vec![tip.into(), position],
                scale: [0.01 * self.size, 0.025 * self.size, 0.0].into(),
                ..marker("forces", id, 0)
            };
            let text = Marker {
                pose: RosPose { position: tip.into(), ..RosPose::default() },
                scale: [0.0, 0.0, 0.05 * self.size].into(),
                text: words(&contact),
                color: Color { r: 1.0, g: 1.0, b: 1.0, a: 1.0 },
                ..marker("texts", id, 9)
            };
            [sphere, arrow, text]
        });
        MarkerArray { markers: std::iter::once(clear).chain(drawn).collect() }
    }

    fn diagnostic(&self, message: String, values: Vec<KeyValue>) -> DiagnosticStatus {
        let (name, hardware_id) = (format!("dermatome: {}", self.name), self.board.clone());
        DiagnosticStatus { level: 0, name, message, hardware_id, values }
    }

    /// What has been wrong since it was told last, in words.
    fn problems(&self, frame: &ScanFrame) -> Vec<&'static str> {
        let is_blind = frame.reflexes.as_ref().is_some_and(|reflexes| reflexes.is_blind);
        let of_reflexes = [(self.tripped > 0, "reflex tripped"), (is_blind, "reflexes blind")];
        let of_reflexes = of_reflexes.into_iter().filter_map(|(is_so, words)| is_so.then_some(words));
        self.flags.words().chain(of_reflexes).collect()
    }

    fn diagnostics(&self, frame: &ScanFrame, now_ns: u64) -> DiagnosticArray {
        let problems = self.problems(frame);
        let mut values = frame.health.as_ref().map(health_values).unwrap_or_default();
        values.extend(frame.reflexes.as_ref().map(|_| tripped_value(self.tripped)));
        let message = if problems.is_empty() { "all is well".to_owned() } else { problems.join(", ") };
        let level = u8::from(!problems.is_empty());
        let status = DiagnosticStatus { level, ..self.diagnostic(message, values) };
        DiagnosticArray { header: self.place.header(now_ns), status: vec![status] }
    }
}

/// Where a skin lies on its link.
#[must_use]
pub fn transform(pose: &Pose, skin: &str, time_ns: u64) -> TransformStamped {
    let [x, y, z, w] = pose.orientation;
    let transform = RosPose { position: pose.position.into(), orientation: Quaternion { x, y, z, w } };
    let header = Place::of(skin, Some(pose)).header(time_ns);
    TransformStamped { header, child_frame_id: skin.to_owned(), transform }
}

/// What lies so for good; programs that seek in a recording take the last message for all that there is.
#[must_use]
pub fn transforms(transforms: Vec<TransformStamped>, now_ns: u64) -> Packed {
    Packed::now(Topic::Transforms, now_ns, cdr::encode(&TfMessage { transforms }))
}

/// What a board says about its electrodes and itself.
#[must_use]
pub fn health_values(report: &HealthReport) -> Vec<KeyValue> {
    let value = |key: &str, value: String| KeyValue { key: key.to_owned(), value };
    let electrodes = |set: ElectrodeSet| {
        let names: Vec<String> = set.iter().map(|electrode| (electrode + 1).to_string()).collect();
        names.join(" ")
    };
    let mut values = vec![
        value("open electrodes", electrodes(report.health.open)),
        value("shorted electrodes", electrodes(report.health.shorted)),
        value("worse electrodes", electrodes(report.health.worse)),
        value("CPU load", format!("{:.3}", report.vitals.load)),
        value("drift", format!("{:.6}", report.drift)),
        value("samples missed", report.missed.to_string()),
    ];
    let temperature = report.vitals.temperature;
    values.extend(temperature.map(|celsius| value("temperature", format!("{celsius:.1}"))));
    values
}

/// Reflexes that are tripped, a bit for each, by their numbers from 1.
#[must_use]
pub fn tripped_value(tripped: u8) -> KeyValue {
    let rules = (0..u8::BITS).filter(|rule| tripped >> rule & 1 == 1).map(|rule| (rule + 1).to_string());
    KeyValue { key: "reflexes tripped".to_owned(), value: rules.collect::<Vec<_>>().join(" ") }
}

/// A contact in words: number, kPa and N, or its strength.
fn words(contact: &Contact) -> String {
    let number = contact.identity.map_or(String::new(), |identity| format!("#{} ", identity.number));
    let load = match (contact.pressure, contact.force()) {
        (Some(pressure), Some(force)) => format!("{:.1} kPa {force:.2} N", pressure * 1e-3),
        (Some(pressure), None) => format!("{:.1} kPa", pressure * 1e-3),
        _ => format!("{:.2}", contact.strength),
    };
    number + &load
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::{pipeline::reflex::Reflexes, protocol::FrameStamp};

    #[test]
    fn a_frame_without_contacts_tells_what_is_wrong_and_never_that_all_is_well() {
        let frame = |flags, reflexes, has_contacts: bool| ScanFrame {
            at: Some(FrameStamp { sequence: 1, timestamp_us: 0, flags }),
            contacts: has_contacts.then(Default::default),
            reflexes,
            ..ScanFrame::default()
        };
        let is_told = |frame| {
            let mut scene = Scene::new("palm".to_owned(), Place::of("palm", None), Vec::new(), String::new());
            let packed = scene.messages(&frame, DIAGNOSTICS_PERIOD);
            packed.iter().any(|packed| packed.topic == Topic::Diagnostics)
        };
        let well = FrameFlags::default();
        let blind = Some(Reflexes { is_blind: true, ..Reflexes::default() });
        assert!(is_told(frame(well, None, true)));
        assert!(!is_told(frame(well, None, false)));
        assert!(is_told(frame(FrameFlags::SATURATED, None, false)));
        assert!(is_told(frame(well, blind, false)));
    }
}
