//! Robot: what those who look on, or at a recording, see of it besides its skins: its links, and how they lie to each other.

use dermatome_link::pose::Pose;
use dermatome_messages::{
    Packed, Topic, cdr,
    clock::now_ns,
    frame::Place,
    scene::{transform, transforms},
    standard::{Color, Marker, MarkerArray, TfMessage, TransformStamped},
};
use dermatome_page::Speaker;
use dermatome_recording::write::Recorder;
use dermatome_urdf::urdf::tree::{Joint, Link, Motion, Robot};
use std::time::{Duration, Instant};

/// How often joints are told.
const PERIOD: Duration = Duration::from_millis(50);
/// A marker of triangles.
const TRIANGLES: i32 = 11;

/// A robot as it is shown.
pub(super) struct Figure {
    speaker: Option<Speaker>,
    recorder: Option<Recorder>,
    joints: Vec<Joint>,
    told: Option<Instant>,
}

impl Figure {
    /// Shows where skins of these places and names lie, and, where the robot's description is known, what its links look like
    /// and which joints never move.
    pub(super) fn show<'a>(
        robot: Option<&Robot>,
        skins: impl Iterator<Item = (&'a Pose, &'a str)>,
        speaker: Option<Speaker>,
        recorder: Option<Recorder>,
    ) -> Self {
        let now = now_ns();
        let mut figure = Self { speaker, recorder, joints: Vec::new(), told: None };
        let mut placed: Vec<_> = skins.map(|(pose, skin)| transform(pose, skin, now)).collect();
        if let Some(robot) = robot {
            let (fixed, moving): (Vec<_>, Vec<_>) =
                robot.joints.iter().cloned().partition(|joint| joint.motion == Motion::Fixed);
            placed.extend(fixed.iter().map(|joint| stamped(joint, 0.0, now)));
            figure.joints = moving;
            figure.send(Packed::now(Topic::Links, now, cdr::encode(&links(robot, now))));
        }
        figure.send(transforms(placed, now));
        figure
    }

    fn send(&mut self, packed: Packed) {
        if let Some(recorder) = &mut self.recorder {
            recorder.record(vec![packed.clone()]);
        }
        if let Some(speaker) = &self.speaker {
            speaker.publish(packed);
        }
    }

    /// Tells now and then where the joints that move are.
    pub(super) fn tell(&mut self, position: impl Fn(&Joint) -> f64) {
        if self.joints.is_empty() || self.told.is_some_and(|told| told.elapsed() < PERIOD) {
            return;
        }
        self.told = Some(Instant::now());
        let now = now_ns();
        let placed = self.joints.iter().map(|joint| stamped(joint, position(joint), now));
        let message = TfMessage { transforms: placed.collect() };
        self.send(Packed::now(Topic::Joints, now, cdr::encode(&message)));
    }
}

fn stamped(joint: &Joint, position: f64, now: u64) -> TransformStamped {
    transform(&joint.pose(position), joint.child(), now)
}

/// The links that are no skins', each a marker of triangles in its own frame.
fn links(robot: &Robot, now: u64) -> MarkerArray {
    let is_skin = |link: &&Link| robot.skins.iter().any(|skin| skin.frame == link.name);
    let shown = robot.links.iter().filter(|link| !is_skin(link) && !link.shape.is_empty());
    let marker = |link: &Link| Marker {
        header: Place::of(&link.name, None).header(now),
        ns: link.name.clone(),
        kind: TRIANGLES,
        scale: [1.0; 3].into(),
        color: Color { r: 0.55, g: 0.58, b: 0.62, a: 1.0 },
        frame_locked: true,
        points: link.shape.iter().flatten().map(|corner| <[f64; 3]>::from(corner.coords).into()).collect(),
        ..Marker::default()
    };
    MarkerArray { markers: shown.map(marker).collect() }
}
