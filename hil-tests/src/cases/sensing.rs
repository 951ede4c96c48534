//! Cases of sensing: what the board measures of the skin in its world.

mod session;

use super::{Case, Failure, check};
use crate::rig::{Capability, Rig};
use dermatome_shared::{protocol::{Event, Selection}, scan::multiplexer_word};
use session::Session;

pub(super) const CASES: &[Case] = &[
    Case { name: "demodulated voltages are those of the circuit", needs: &[Capability::VirtualTime], run: voltages },
];

fn voltages(rig: &Rig) -> Result<String, Failure> {
    let mut session = Session::open(rig, |_| ())?;
    session.scene.noise(false);
    session.tare(2)?;
    let (_, drive) = session.front_end()?;
    let current = f64::from(drive.amplitude);
    let measured = session.voltages(3)?;
    let steps: Vec<_> = session.patch().steps().collect();
    let truth: Vec<_> = steps.iter().map(|step| session.scene.truth(multiplexer_word(*step)) * current).collect();
    let full = truth.iter().map(|v| v.norm()).fold(0.0, f64::max);
    let (mut sxy, mut sxx) = (0.0, 0.0);
    for (m, t) in measured[0].iter().zip(&truth) { sxy += m[0] * t.re; sxx += t.re * t.re; }
    eprintln!("scale {} full {}", sxy / sxx, full);
    for (i, (m, t)) in measured[0].iter().zip(&truth).enumerate().take(30) {
        eprintln!("{i} {:?} truth {:.6e} {:.6e} err {:.4} %FS imag {:.4}", m, t.re, t.im, 100.0*(m[0]-t.re)/full, 100.0*(m[1]-t.im)/full);
    }
    let worst = measured[0].iter().zip(&truth).map(|(m, t)| ((m[0] - t.re) / full).abs()).fold(0.0, f64::max);
    session.stream(Selection { health: 1, ..Selection::default() })?;
    let health = session.find(|event| match event { Event::Health { at, health, vitals, .. } => Some((at, health, vitals)), _ => None })?;
    eprintln!("{health:?}");
    Ok(format!("worst {:.4} %", 100.0 * worst))
}
