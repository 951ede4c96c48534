//! `dermatome check`.

use super::{
    BoardReport, JsonReport,
    board::open,
    check_skin::{self, Compared, Model},
    drive::rounded,
    interrupt,
    tare::patch_of,
};
use anyhow::{Context, bail};
use dermatome_link::{
    Link, LinkError,
    health::{self, Diagnosis, Electrode, Finding, FittedCurrent, Known, State, Watch, fit_current},
    silence_timeout,
};
use dermatome_shared::{
    acquire::FrontEnd,
    drive::Drive,
    frame::FrameFlags,
    protocol::{FrameSource, PatchInfo, Request},
    scan::Timing,
};
use dermatome_simulate::port::Port;
use serde::Serialize;
use std::{path::PathBuf, time::Duration};

/// Frames from which contact impedances are measured with a smaller current.
const CONTACT_FRAMES: usize = 10;
/// Each smaller current is this part of the one before.
const SMALLER: f32 = 0.25;
/// Smaller currents that are tried.
const SMALLER_CURRENTS: usize = 3;
/// Carrier at which the capacitance of leads takes little, Hz.
const LOW_FREQUENCY: f32 = 12.5e3;
/// Leads are to blame where the reciprocity error falls to this part of itself there.
const LEAKS: f32 = 0.5;
/// Noise explains a reciprocity error up to so many times what it makes on average.
const NOISE: f64 = 1.5;

/// Look for what is wrong with a board and its skin, and say what to do.
///
/// Watches some frames: contact impedance and state of every electrode, reciprocity, what was wrong
/// with frames, and how the board itself does. Where the current is too large for voltages or the electrodes' tests, or
/// the frequency too high for the leads, they are repeated with a smaller one, and the board tares anew. With the skin file its
/// voltages, which must be those of the untouched skin, are compared with the model's as well: order of the wires, shape,
/// the sheet's conductivity. Exits with
/// code 1 if something is wrong.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome check --port /dev/ttyACM0\n  \
    dermatome check --port /dev/ttyACM0 --skin skin.toml\n  \
    dermatome check --port tcp:127.0.0.1:7000 --json check.json")]
pub(super) struct Args {
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS or sim:SKIN.toml.
    #[arg(long)]
    port: Port,
    /// Frames to look at.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..))]
    frames: u16,
    /// Skin file of the skin, which nothing touches: compare voltages and sheet with its model.
    #[arg(long, value_name = "FILE")]
    skin: Option<PathBuf>,
    #[command(flatten)]
    json: JsonReport,
}

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    board: BoardReport<'a>,
    frame_rate_asked: f32,
    #[serde(flatten)]
    examined: Examined,
}

/// What a board's frames say about it and its skin.
#[derive(Serialize)]
pub(super) struct Examined {
    /// Current with which contact impedances were measured.
    contact_amplitude_a: f32,
    #[serde(flatten)]
    pub(super) diagnosis: Diagnosis,
    pub(super) model: Option<Compared>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let model = args.skin.as_deref().map(Model::of).transpose()?;
    let mut link = open(&args.port)?;
    let patch = patch_of(&mut link)?;
    model.as_ref().map_or(Ok(()), |model| model.check_steps(&mut link, &patch))?;
    let Some(examined) = examine(&mut link, &patch, model.as_ref(), args.frames.into())? else {
        bail!("stopped before the first frame came")
    };
    if model.is_some() && examined.model.is_none() && !interrupt::requested() {
        eprintln!("not compared with the skin file: first mend what is wrong with electrodes and current");
    }
    let board = BoardReport::new(&link, &patch);
    let report = Report { board, frame_rate_asked: patch.drive.frame_rate, examined };
    print(&report);
    args.json.write(&report)?;
    match report.examined.diagnosis.findings.len() {
        0 => Ok(()),
        1 => bail!("one thing is wrong with the board or its skin: see above"),
        many => bail!("{many} things are wrong with the board or its skin: see above"),
    }
}

/// Watches so many frames, and compares as many with a model; none where Ctrl-C comes before the first. Where current or
/// frequency of the drive in effect leave nothing to be seen, others are used, and it is told.
pub(super) fn examine(
    link: &mut Link,
    patch: &PatchInfo,
    model: Option<&Model<'_>>,
    frames: usize,
) -> anyhow::Result<Option<Examined>> {
    let drive = link.info()?.drive.unwrap_or(patch.drive);
    let timeout = silence_timeout(patch);
    let mut examination =
        Examination { drive, timeout, findings: Vec::new(), explained: FrameFlags::default() };
    let examined = examination.run(link, patch, model, frames);
    if examination.drive != drive {
        // Whatever happened, the drive is what it was.
        link.request(&Request::Drive(Some(drive)))?;
    }
    examined
}

/// An examination under way.
struct Examination {
    /// With which voltages are measured by now.
    drive: Drive,
    timeout: Duration,
    /// What is wrong with the drive.
    findings: Vec<Finding>,
    /// Flags that follow from it.
    explained: FrameFlags,
}

impl Examination {
    fn run(
        &mut self,
        link: &mut Link,
        patch: &PatchInfo,
        model: Option<&Model<'_>>,
        frames: usize,
    ) -> anyhow::Result<Option<Examined>> {
        let info = link.info()?;
        let mut watch = self.watch(link, frames)?;
        if watch.is_saturated() && !interrupt::requested() {
            watch = self.lower_current(link, watch, frames)?;
        }
        if watch.is_not_reciprocal() && !interrupt::requested() {
            self.explain_by_noise(link, &watch, frames)?;
        }
        let is_explained = self.explained.contains(FrameFlags::NOT_RECIPROCAL);
        if let Some(front_end) = info.front_end
            && watch.is_not_reciprocal()
            && !is_explained
            && !interrupt::requested()
        {
            watch = self.lower_frequency(link, watch, frames, &front_end)?;
        }
        let mut contact_amplitude_a = self.drive.amplitude;
        if watch.has_clipped_tests() && !interrupt::requested() {
            let measured = measure_contacts(link, &mut watch, self.drive, self.timeout);
            link.request(&Request::Drive(Some(self.drive)))?;
            contact_amplitude_a = measured?;
        }
        let is_comparable = watch.has_sound_electrodes();
        let model = match model {
            Some(model) if is_comparable && !interrupt::requested() => {
                let front_end =
                    info.front_end.context("this board does not say how many volts its codes are")?;
                let ohms = f64::from(front_end.volts_per_code / self.drive.amplitude);
                let frames = check_skin::frames(link, frames, ohms, self.timeout)?;
                frames.map(|frames| model.compare(&frames, patch)).transpose()?
            }
            _ => None,
        };
        if let Some(compared) = &model {
            watch.add_to_contacts(&compared.missing(&link.test_resistances()?));
        }
        let is_simulated = info.frame_source == FrameSource::Simulated;
        let known = Known {
            flags: self.explained,
            sheet: model.as_ref().is_some_and(Compared::has_sheet),
            wires: model.as_ref().is_some_and(|compared| compared.wires_are_wrong),
        };
        let Some(mut diagnosis) = watch.diagnosis(is_simulated, known) else { return Ok(None) };
        diagnosis.findings.append(&mut self.findings);
        diagnosis.findings.extend(model.iter().flat_map(|compared| compared.findings.iter().cloned()));
        Ok(Some(Examined { contact_amplitude_a, diagnosis, model }))
    }

    fn watch(&self, link: &mut Link, frames: usize) -> Result<Watch, LinkError> {
        health::watch(link, frames, self.timeout, || !interrupt::requested())
    }

    /// Halves a current that voltages have no room for; gives what is seen with the smaller one.
    fn lower_current(&mut self, link: &mut Link, watch: Watch, frames: usize) -> Result<Watch, LinkError> {
        let fitted = fit_current(link, self.drive, self.timeout, || !interrupt::requested())?;
        let Some(fitted) = fitted.filter(FittedCurrent::is_lowered) else { return Ok(watch) };
        self.drive.amplitude = fitted.amplitude;
        let [before, now] = [fitted.before, fitted.amplitude].map(|amplitude| rounded(1e3 * amplitude));
        self.explained.insert(FrameFlags::SATURATED);
        self.findings.push(Finding {
            what: format!("voltages clip at {before} mA, and not at {now} mA"),
            advice: format!(
                "set `drive.amplitude` = \"{now} mA\" in the skin file; `dermatome setup` does that on the board, and \
                 `stream` and `tare` for as long as it runs"
            ),
        });
        self.watch(link, frames)
    }

    /// Says so where noise is why voltages are not reciprocal.
    fn explain_by_noise(&mut self, link: &mut Link, watch: &Watch, frames: usize) -> Result<(), LinkError> {
        let Some(frames) = check_skin::frames(link, frames, 1.0, self.timeout)? else { return Ok(()) };
        let noise = check_skin::difference_by_noise(&frames);
        let error = f64::from(watch.reciprocity().unwrap_or(0.0));
        if error > NOISE * noise {
            return Ok(());
        }
        self.explained.insert(FrameFlags::NOT_RECIPROCAL);
        self.findings.push(Finding {
            what: format!(
                "noise is large beside the voltages: with drive and sense exchanged they differ by {:.0} %, as noise \
                 alone makes them ({:.0} %)",
                100.0 * error,
                100.0 * noise
            ),
            advice: "raise `dermatome drive --amplitude`, or `--integration`, which costs frames".to_owned(),
        });
        Ok(())
    }

    /// Where voltages are not reciprocal because the leads' capacitance takes much of the current, they are at a lower
    /// carrier frequency; gives what is seen there.
    fn lower_frequency(
        &mut self,
        link: &mut Link,
        watch: Watch,
        frames: usize,
        front_end: &FrontEnd,
    ) -> Result<Watch, LinkError> {
        let before = self.drive;
        let low = Drive { frequency: LOW_FREQUENCY, ..before };
        if low.frequency >= before.frequency || Timing::new(&low, front_end.sample_rate).is_none() {
            return Ok(watch);
        }
        self.drive = low;
        link.request(&Request::Drive(Some(low)))?;
        let fitted = fit_current(link, low, self.timeout, || !interrupt::requested())?;
        self.drive.amplitude = fitted.map_or(low.amplitude, |fitted| fitted.amplitude);
        let lower = self.watch(link, frames)?;
        let errors = [&watch, &lower].map(|watch| 100.0 * watch.reciprocity().unwrap_or(0.0));
        if errors[1] > LEAKS * errors[0] {
            self.drive = before;
            link.request(&Request::Drive(Some(before)))?;
            return Ok(watch);
        }
        let [high, low] = [before, low].map(|drive| rounded(1e-3 * drive.frequency));
        self.explained.insert(FrameFlags::NOT_RECIPROCAL);
        self.findings.push(Finding {
            what: format!(
                "leads take current that the skin should get: voltages with drive and sense exchanged differ by {:.0} % \
                 at {high} kHz, by {:.0} % at {low} kHz, at which all this was measured",
                errors[0], errors[1]
            ),
            advice: format!("set `drive.frequency` = \"{low} kHz\" in the skin file, or shorten the leads"),
        });
        Ok(lower)
    }
}

/// Repeats the electrodes' tests with ever smaller currents until they fit; says with which.
fn measure_contacts(
    link: &mut Link,
    watch: &mut Watch,
    mut drive: Drive,
    timeout: Duration,
) -> Result<f32, LinkError> {
    for _ in 0..SMALLER_CURRENTS {
        drive.amplitude *= SMALLER;
        link.request(&Request::Drive(Some(drive)))?;
        let smaller = health::watch(link, CONTACT_FRAMES, timeout, || !interrupt::requested())?;
        watch.take_contacts(&smaller);
        if !watch.has_clipped_tests() || interrupt::requested() {
            break;
        }
    }
    Ok(drive.amplitude)
}

/// Electrodes from 1, as people count them.
fn print(report: &Report<'_>) {
    let Diagnosis { electrodes, findings, .. } = &report.examined.diagnosis;
    print_electrodes(electrodes);
    let rows = rows(report).into_iter().chain(report.examined.model.iter().flat_map(Compared::rows));
    rows.for_each(|(name, value)| say!("{name:<18} {value}"));
    if findings.is_empty() {
        say!("nothing looks wrong");
    }
    for finding in findings {
        say!("wrong: {}: {}", finding.what, finding.advice);
    }
}

/// A row for each.
pub(super) fn print_electrodes(electrodes: &[Electrode]) {
    if electrodes.is_empty() {
        say!("this board does not test its electrodes");
    } else {
        say!("{:>9} {:>21}  state", "electrode", "contact impedance/ohm");
    }
    for electrode in electrodes {
        let ohms = match electrode.state {
            State::Open | State::Unknown => "-".to_owned(),
            _ => electrode.contact_impedance_ohm.map_or("too large".to_owned(), |ohms| format!("{ohms:.1}")),
        };
        say!("{:>9} {ohms:>21}  {}", electrode.electrode + 1, word(electrode.state));
    }
}

fn word(state: State) -> &'static str {
    match state {
        State::Ok => "ok",
        State::High => "high",
        State::Unknown => "unknown",
        State::Open => "open",
        State::Shorted => "shorted",
        State::Worse => "worse than before",
    }
}

fn rows(report: &Report<'_>) -> Vec<(&'static str, String)> {
    let Examined { contact_amplitude_a, diagnosis, .. } = &report.examined;
    let percent = |value: f32| format!("{value:.2} %");
    let or = |value: Option<String>, none: &str| value.unwrap_or_else(|| none.to_owned());
    let flags = diagnosis.flags.iter().map(|(words, frames)| format!("{words} ({frames})"));
    let flags = flags.collect::<Vec<_>>().join(", ");
    let rate = diagnosis.frames_per_second.map(|rate| format!("{rate:.1} a second"));
    let asked = report.frame_rate_asked;
    vec![
        ("frames", format!("{}, {} (asked for {asked})", diagnosis.frames, or(rate, "one only"))),
        ("contacts tested at", format!("{} mA", rounded(1e3 * contact_amplitude_a))),
        (
            "reciprocity error",
            or(diagnosis.reciprocity_error_percent.map(percent), "not measured by this patch"),
        ),
        ("drift taken out", percent(diagnosis.drift_percent)),
        ("temperature", or(diagnosis.temperature_c.map(|celsius| format!("{celsius:.1} C")), "not measured")),
        ("CPU load", or(diagnosis.load_percent.map(percent), "not measured")),
        ("free stack", or(diagnosis.free_stack_bytes.map(|bytes| format!("{bytes} bytes")), "not measured")),
        ("flags", if flags.is_empty() { "none".to_owned() } else { flags }),
    ]
}
