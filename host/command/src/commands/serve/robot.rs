//! Robot: what those who look on, or at a recording, see of it besides its skins: its links, and how they lie to each other.

use dermatome_messages::{
    Packed, Topic, cdr,
    clock::now_ns,
    frame::Place,
    scene::transform,
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
    /// Shows what its links look like.
    pub(super) fn show(robot: &Robot, speaker: Option<Speaker>, recorder: Option<Recorder>) -> Self {
        let moves = |joint: &&Joint| joint.motion != Motion::Fixed;
        let joints = robot.joints.iter().filter(moves).cloned().collect();
        let mut figure = Self { speaker, recorder, joints, told: None };
        let now = now_ns();
        figure.send(Packed::now(Topic::Links, now, cdr::encode(&links(robot, now))));
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
        if self.told.is_some_and(|told| told.elapsed() < PERIOD) {
            return;
        }
        self.told = Some(Instant::now());
        let now = now_ns();
        let placed = self.joints.iter().map(|joint| stamped(joint, position(joint), now));
        let message = TfMessage { transforms: placed.collect() };
        self.send(Packed::now(Topic::Joints, now, cdr::encode(&message)));
    }
}

/// The joints that never move.
pub(super) fn fixed(robot: &Robot) -> Vec<TransformStamped> {
    let now = now_ns();
    let fixed = robot.joints.iter().filter(|joint| joint.motion == Motion::Fixed);
    fixed.map(|joint| stamped(joint, 0.0, now)).collect()
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
