//! Any drive that a host may ask for, of any patch that passes the checks, and any samples: frames have a code for
//! each step, and none takes the board down.
#![no_main]

use arbitrary::Arbitrary;
use dermatome_shared::{
    acquire::{Acquisition, CurrentRange, FrontEnd, trim::Trim},
    drive::{Component, Drive, Gain},
    patch::PatchView,
};
use dermatome_shared_fuzz::{damage, small_patch};
use libfuzzer_sys::fuzz_target;

/// As the boards have it.
const FRONT_END: FrontEnd = FrontEnd {
    sample_rate: 2_000_000,
    volts_per_code: 3.3 / 4096.0 / 4096.0 / 19.93,
    full_scale_current: 1e-3,
    small_range: Some(CurrentRange { full_current: 28.73e-6, bandwidth: 163.3e3 }),
    gain_bandwidth: 13e6,
    largest_gain: 64,
    bandwidths: [844e3, 157.4e3, 10e6, 965e3],
    lead_corner: 575e3,
    waveform_rate: 1_000_000,
    lead: -1.3e-6,
    trim: Trim::NONE,
};

#[derive(Arbitrary, Debug)]
struct Input {
    edits: Vec<u8>,
    frequency: f32,
    /// Frequencies that a carrier can have are few among all: this many samples a period, unless 0.
    period: u8,
    amplitude: f32,
    frame_rate: f32,
    phase: f32,
    settling: f32,
    integration: u8,
    gain: Option<u8>,
    is_magnitude: bool,
    watched: Option<u16>,
    samples: Vec<u16>,
    pieces: u8,
    restarts_after: u8,
}

fn drive(input: &Input) -> Drive {
    let frequency = match input.period {
        0 => input.frequency,
        period => FRONT_END.sample_rate as f32 / f32::from(period),
    };
    Drive {
        frequency,
        amplitude: input.amplitude,
        frame_rate: input.frame_rate,
        phase: input.phase,
        settling: input.settling,
        integration: input.integration,
        gain: input.gain.map_or(Gain::Automatic, Gain::Fixed),
        component: if input.is_magnitude { Component::Magnitude } else { Component::Real },
    }
}

fuzz_target!(|input: Input| {
    let bytes = damage(small_patch(), &input.edits);
    let Ok(patch) = PatchView::validate(&bytes) else { return };
    let drive = drive(&input);
    if drive.check().is_err() {
        return;
    }
    let Some(mut acquisition) = Acquisition::new(&patch, &drive, &FRONT_END) else { return };
    acquisition.watch(input.watched);
    let piece = usize::from(input.pieces) + 1;
    // All over again, so that few samples make some frames.
    let samples: Vec<u16> = input.samples.iter().map(|code| code % 4096).cycle().take(20_000).collect();
    for (number, piece) in samples.chunks(piece).enumerate() {
        if input.restarts_after > 0 && number == usize::from(input.restarts_after) {
            acquisition.restart();
        }
        acquisition.push(piece, |frame, _| {
            assert_eq!(frame.codes.len(), patch.steps().count());
        });
        assert_eq!(acquisition.gains().len(), acquisition.slots().len());
    }
});
