//! Asked: what a desk does when the page asks for it.

use super::{
    super::{
        calls::{self, Change, DRIVE, Index, PATCH, RECORD, Readings, SCOPE, Slot, Start, THRESHOLD, Value},
        prepared::Prepared,
    },
    Desk, Present,
};
use crate::commands::{
    check,
    check_skin::Model,
    drive::rounded,
    outlets::recorded_in_words,
    outputs::{Kind, by_default},
    stream::session::Session as Board,
};
use anyhow::{Context, bail, ensure};
use dermatome_frames::calibrate::{Fit, Reading};
use dermatome_link::{self as link, Subscription};
use dermatome_page::Call;
use dermatome_patch::{output::write_whole, write::with_calibration};
use dermatome_shared::protocol::{PatchInfo, Request};
use serde_json::{Value as Json, json};
use std::path::Path;

/// Frames that `check` looks at.
const CHECKED_FRAMES: usize = 20;

impl Desk<'_> {
    /// Does what was asked between two frames.
    pub(super) fn answer(
        &mut self,
        call: &Call,
        stream: &mut Subscription<'_>,
        patch: &mut PatchInfo,
        present: &Present,
    ) -> anyhow::Result<Json> {
        match call.service {
            DRIVE => {
                let wanted = calls::request::<Change>(call)?.of(&patch.drive)?;
                stream.link().request(&Request::Drive(Some(wanted)))?;
                (patch.drive, self.drive) = (wanted, Some(wanted));
                self.show_drive(&wanted, present);
                self.outlets.tare(stream.link())?;
                Ok(json!({}))
            }
            PATCH => {
                let Index { index } = calls::request(call)?;
                ensure!(
                    index <= self.task.patches.len(),
                    "`index` is {index}; allowed: 0 to {}",
                    self.task.patches.len()
                );
                self.choose(index, present)?;
                Ok(json!({}))
            }
            THRESHOLD => {
                let Value { value } = calls::request(call)?;
                ensure!((0.0..=100.0).contains(&value), "`value` is {value}; allowed: 0 to 100");
                self.threshold = value;
                Ok(json!({}))
            }
            SCOPE => {
                let Slot { slot } = calls::request(call)?;
                ensure!(present.sample_rate.is_some() || slot.is_none(), "this board has no samples to show");
                let last = present.steps.len() + usize::from(stream.link().info()?.electrodes);
                let is_there = slot.is_none_or(|slot| usize::from(slot) < last);
                ensure!(is_there, "`slot` is {}; allowed: 0 to {}", slot.unwrap_or(0), last - 1);
                self.slot = slot;
                Ok(json!({}))
            }
            RECORD => {
                let Start { start } = calls::request(call)?;
                if !start {
                    return self.stopped();
                }
                ensure!(self.outlets.recorder().is_none(), "a recording is under way");
                let file = recording_name(&present.session.skin);
                self.outlets.record(Path::new(&file), &present.session)?;
                // Raw codes must come from the first frame of the tare on.
                stream.reselect(self.selection(patch))?;
                self.outlets.tare(stream.link())?;
                Ok(json!({ "file": file }))
            }
            other => bail!("there is no service `{other}`"),
        }
    }

    /// Images are made with another patch from the next frame on.
    fn choose(&mut self, index: usize, present: &Present) -> anyhow::Result<()> {
        let patch = index.checked_sub(1).and_then(|index| self.task.patches.get(index));
        let tare = self.outlets.last_tare();
        self.prepared = patch.map(|(_, patch)| Prepared::new(patch, &present.steps, tare)).transpose()?;
        self.chosen = index;
        self.show_patch(present);
        Ok(())
    }

    fn stopped(&mut self) -> anyhow::Result<Json> {
        let Some((file, recorded)) = self.outlets.finish_recording()? else {
            bail!("nothing is being recorded")
        };
        eprintln!("{}", recorded_in_words(&file, &recorded));
        Ok(json!({ "file": file, "bytes": recorded.bytes, "frames": recorded.frames }))
    }

    /// Ends the recording, with or without a board.
    pub(super) fn stop_recording(&mut self, call: Call) {
        let done = match calls::request::<Start>(&call) {
            Ok(Start { start: false }) => self.stopped().map_err(|error| format!("{error:#}")),
            Ok(_) => Err("there is no board to record".to_owned()),
            Err(error) => Err(format!("{error:#}")),
        };
        call.answer(done);
    }

    /// Looks for what is wrong, as `check` does.
    pub(super) fn check(&mut self, board: &mut Board<'_>) -> anyhow::Result<Json> {
        self.state("taring", "looking at the board and its skin", "do not touch the skin until it is done");
        let model = self.task.skin.map(Model::of).transpose()?;
        let patch = board.patch.clone();
        let link = board.link()?;
        let examined = check::examine(link, &patch, model.as_ref(), CHECKED_FRAMES)?;
        let examined = examined.context("stopped before the first frame came")?;
        let findings: Vec<Json> = examined
            .diagnosis
            .findings
            .iter()
            .map(|finding| json!({ "level": "fault", "found": finding.what, "advice": finding.advice }))
            .collect();
        let summary = match findings.len() {
            0 => "nothing is wrong with the board or its skin".to_owned(),
            1 => "one thing is wrong".to_owned(),
            many => format!("{many} things are wrong"),
        };
        Ok(json!({ "summary": [summary], "findings": findings }))
    }

    /// Fits a curve to readings, and gives the board the calibrated patch.
    pub(super) fn calibrate(
        &mut self,
        call: &Call,
        board: &mut Board<'_>,
        present: &Present,
    ) -> anyhow::Result<Json> {
        let Readings { readings } = calls::request(call)?;
        let is_number = |read: &calls::Read| {
            (0.0..1e6).contains(&read.pressure_kpa) && (0.0..1e3).contains(&read.strength)
        };
        ensure!(readings.iter().all(is_number), "allowed: pressures (kPa) and strengths of 0 or more");
        let reading = |read: &calls::Read| Reading {
            pressure_kpa: read.pressure_kpa,
            strength: read.strength,
            deviation: 0.0,
            area_mm2: None,
            place: None,
        };
        let readings: Vec<Reading> = readings.iter().map(reading).collect();
        let fit = Fit::new(&readings, None, false).context("the readings")?;
        let calibrated = with_calibration(&present.session.patch, &fit.stored())?;
        let default = format!("{}-calibrated.dermatome", present.session.skin);
        let file = by_default("calibrate", None, default, Kind::Patch)?;
        write_whole(&file, &calibrated)?;
        link::upload(board.link()?, &calibrated, |_| ())
            .context("the calibrated patch was written, but not sent")?;
        let points = fit.calibration.points.len();
        let least =
            rounded(readings.iter().map(|read| read.pressure_kpa).fold(f64::INFINITY, f64::min) as f32);
        let most = rounded(readings.iter().map(|read| read.pressure_kpa).fold(0.0, f64::max) as f32);
        let file = file.display().to_string();
        let text = format!(
            "calibrated from {least} to {most} kPa, {points} points; the board has it, and {file} too"
        );
        Ok(json!({ "text": text, "file": file }))
    }
}

/// A file for a recording, in this folder: the skin and the first number that is free.
fn recording_name(skin: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    let plain: String = skin.chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
    let mut names = (1_u32..).map(|number| format!("{plain}-{number}.mcap"));
    names.find(|name| !Path::new(name).exists()).unwrap_or_default()
}
