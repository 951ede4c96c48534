//! Touches: what presses the arm, where, and when.

use dermatome_geometry::outline::Outline;
use dermatome_link::pose::Pose;
use dermatome_simulate::{Press, Script, ScriptError, script::Moment};
use nalgebra::Point3;

/// The script's length, s; then it begins anew.
pub(crate) const SECONDS: f64 = 10.0;
/// Radius of a finger, m.
const FINGER: f64 = 8e-3;
/// Relative conductivity change under a finger's centre.
const DEPTH: f64 = 1.0;

/// One touch of a skin; places are shares of the way from its middle to its rim, along x and y of its frame.
struct Touch {
    patch: &'static str,
    /// s
    begin: f64,
    /// s
    end: f64,
    from: [f64; 2],
    /// Elsewhere than `from`, for a stroke.
    to: [f64; 2],
}

const fn press(patch: &'static str, begin: f64, end: f64, at: [f64; 2]) -> Touch {
    Touch { patch, begin, end, from: at, to: at }
}

/// One skin at a time, two, all three, and a stroke along the upper arm while the hand is held.
const TOUCHES: [Touch; 8] = [
    press("upper_arm", 0.5, 2.0, [0.0, 0.0]),
    press("forearm", 2.2, 3.7, [0.3, 0.35]),
    press("hand", 2.2, 3.7, [-0.3, 0.2]),
    press("upper_arm", 4.0, 5.8, [-0.4, 0.3]),
    press("forearm", 4.0, 5.8, [-0.25, -0.4]),
    press("hand", 4.0, 5.8, [0.3, -0.3]),
    Touch { patch: "upper_arm", begin: 6.2, end: 9.4, from: [0.0, -0.55], to: [0.0, 0.55] },
    press("hand", 7.0, 9.4, [0.0, 0.35]),
];

/// The touches of one skin.
#[derive(Clone, Debug)]
pub(crate) struct Trail {
    touches: Vec<TouchOfSkin>,
}

/// A touch, by its moments.
#[derive(Clone, Debug)]
struct TouchOfSkin {
    moments: Vec<Moment>,
    /// Where it is in the link's frame at the beginning of each step of time, m.
    places: Vec<[f64; 3]>,
}

/// Steps of time in which places are kept.
const STEP: f64 = 0.01;

impl Trail {
    /// That of a patch whose skin has this outline; it is nowhere before it is [laid](Self::lay).
    pub(crate) fn of(patch: &str, outline: &Outline) -> Self {
        let [x, y] = outline.half_size();
        let middle = outline.middle();
        let moment = |time: f64, [right, up]: [f64; 2]| {
            let position = [middle.x + right * x, middle.y + up * y];
            Moment { time, press: Press::finger(position, FINGER, DEPTH) }
        };
        let of_skin = TOUCHES.iter().filter(|touch| touch.patch == patch);
        let touch = |touch: &Touch| TouchOfSkin {
            moments: vec![moment(touch.begin, touch.from), moment(touch.end, touch.to)],
            places: Vec::new(),
        };
        Self { touches: of_skin.map(touch).collect() }
    }

    /// As a board plays it, over and over.
    pub(crate) fn script(&self, outline: &Outline) -> Result<Script, ScriptError> {
        let nothing = Press::finger(outline.middle().into(), FINGER, 0.0);
        let all = [0.0, SECONDS].map(|time| Moment { time, press: nothing.clone() });
        let fingers = self.touches.iter().map(|touch| touch.moments.clone());
        Script::new(fingers.chain([all.to_vec()]).collect(), outline)
    }

    /// Finds where its touches are on the link; `on_skin` gives the point of the skin at x, y of its frame.
    pub(crate) fn lay(&mut self, pose: &Pose, on_skin: impl Fn([f64; 2]) -> Point3<f64>) {
        for touch in &mut self.touches {
            let steps = (touch.length() / STEP).ceil() as usize;
            let times = (0..=steps).map(|step| touch.begin() + (step as f64 * STEP).min(touch.length()));
            let presses = times.filter_map(|time| Script::at(&touch.moments, time));
            touch.places = presses.map(|press| pose.point(on_skin(press.position).into())).collect();
        }
    }

    /// How many touches there are.
    pub(crate) fn len(&self) -> usize {
        self.touches.len()
    }

    /// When a touch begins and ends, s.
    pub(crate) fn times(&self, touch: usize) -> [f64; 2] {
        let touch = &self.touches[touch];
        [touch.begin(), touch.begin() + touch.length()]
    }

    /// Where a touch is in the link's frame, m; none while it is not.
    pub(crate) fn place(&self, touch: usize, time: f64) -> Option<[f64; 3]> {
        let touch = &self.touches[touch];
        let since = time - touch.begin();
        let is_there = (0.0..=touch.length()).contains(&since);
        touch.places.get((since / STEP).round() as usize).filter(|_| is_there).copied()
    }
}

impl TouchOfSkin {
    fn begin(&self) -> f64 {
        self.moments[0].time
    }

    fn length(&self) -> f64 {
        self.moments[1].time - self.moments[0].time
    }
}
