//! What the fingers do in the demo.

use dermatome_geometry::outline::Outline;
use dermatome_simulate::{Press, Script, ScriptError, script::Moment};
use std::f64::consts::TAU;

/// Frames of the demo.
pub(crate) const FRAMES: u32 = 300;
/// Frames in which one finger travels.
const TRAVEL_FRAMES: u32 = 220;
/// Turns of the spiral.
const TURNS: f64 = 2.5;
/// How far out the spiral ends, as a share of the way to the rim.
const REACH: f64 = 0.8;
/// Radius of a finger, as a share of the skin's half width.
const FINGER: f64 = 0.12;
/// Relative conductivity change under a finger's centre.
const DEPTH: f64 = 1.0;

/// One finger travels outwards on a spiral, then two fingers press.
pub(crate) fn script(outline: &Outline, frame_rate: f64) -> Result<Script, ScriptError> {
    let [x, y] = outline.half_size();
    let at = |frame: u32, angle: f64, reach: f64| {
        let position = [x * reach * angle.cos(), y * reach * angle.sin()];
        let press = Press::finger(position, FINGER * x.min(y), DEPTH);
        Moment { time: f64::from(frame) / frame_rate, press }
    };
    let spiral = (0..TRAVEL_FRAMES).map(|frame| {
        // The root keeps the finger's speed about the same all along the spiral.
        let share = (f64::from(frame) / f64::from(TRAVEL_FRAMES - 1)).sqrt();
        at(frame, share * TURNS * TAU, share * REACH)
    });
    let second = TRAVEL_FRAMES + 1..FRAMES;
    let resting = |angle: f64| vec![at(second.start, angle, 0.55), at(second.end, angle + 0.4, 0.55)];
    Script::new(vec![spiral.collect(), resting(0.4), resting(3.3)], outline)
}
