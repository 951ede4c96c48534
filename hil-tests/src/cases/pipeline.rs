//! Cases of the pipeline on the board: images as the host computes them, and how fast.

use super::{Case, Failure, ensure, ensure_complete, next_frame, patches};
use crate::machine::Machine;
use crate::probe::emulated::LogReader;
use crate::rig::{Capability, Rig, VirtualRig};
use dermatome::link::{
    self, Link, ScanFrame, Subscription,
    assemble::Measurements,
    program::{firmware::Firmware, log::Log},
};
use dermatome_shared::{
    contact::{Contacts, track::Identity},
    drive::Drive,
    frame::Frame,
    patch::PatchView,
    pipeline::{self, Outcome, PipelineState},
    protocol::{FrameStamp, PackedImage, Reply, Request, Selection},
};
use std::{sync::Arc, time::Duration};

/// Images compared.
const FRAMES: usize = 1000;
const TARE_FRAMES: u16 = 20;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "a thousand images and contacts are the host's, bit for bit",
        needs: &[Capability::VirtualTime],
        run: images,
    },
    Case {
        name: "the reconstruction takes at most 2.2 cycles for each product",
        needs: &[Capability::VirtualTime],
        run: kernel,
    },
    Case {
        name: "prefetch and caches of the flash are on",
        needs: &[Capability::VirtualTime],
        run: flash_accelerates,
    },
    Case {
        name: "`kernel_cycles` measures the patch that the board holds",
        needs: &[Capability::Log, Capability::Program],
        run: kernel_cycles,
    },
    Case {
        name: "on a full line, events that others overtook come in their turn",
        needs: &[Capability::VirtualTime],
        run: full_line,
    },
    Case {
        name: "two runs of the same session leave the same trace",
        needs: &[Capability::VirtualTime],
        run: repeats,
    },
];

/// Most cycles for each product of pixels and measurements, of which a patch holds some half.
const MOST_CYCLES: f64 = 2.2;
/// The shipped skins whose electrodes are on the rim. Fewer pixels of hemisphere-210mm-designed can be interpolated: 2.44.
const SKINS: [&str; 6] =
    ["square-210mm", "square-50mm", "saline-215mm", "disc-210mm", "hemisphere-120mm", "hemisphere-210mm"];

/// Counts every cycle of `reconstruct`.
fn kernel(rig: &Rig) -> Result<String, Failure> {
    let VirtualRig { firmware, board, .. } = rig.emulated_rig();
    let missing = || Failure::wrong("the firmware has no function `reconstruct`");
    let function = firmware.symbol("11reconstruct11reconstruct").ok_or_else(missing)?;
    let mut link = rig.link()?;
    let mut found = Vec::new();
    for skin in SKINS {
        let patch = patches::shipped(skin)?;
        link::upload(&mut link, &patch, |_| ())?;
        link::tare(&mut link, 2, Duration::from_secs(20))?;
        board.with(move |machine| machine.count_calls(function as u32));
        let stream = link.subscribe(Selection { images: 1, contacts: 1, ..Selection::default() })?;
        rig.wait(Duration::from_millis(500))?;
        stream.stop()?;
        let calls = board.with(|machine| machine.calls());
        ensure(calls.len() >= 3, || format!("only {} calls", calls.len()))?;
        let header = PatchView::open(&patch).map_err(Failure::wrong)?.header;
        let products = f64::from(header.pixels) * f64::from(header.measurements);
        // Those of handlers are not in it, but what they push out of the caches is.
        let most = calls.iter().max().copied().unwrap_or(u64::MAX) as f64;
        found.push((most / products, most / 170e3, skin));
    }
    let (per_product, ms, skin) =
        found.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
    ensure(per_product <= MOST_CYCLES, || format!("{per_product:.2} cycles for each product of {skin}"))?;
    Ok(format!(
        "{:.2} to {per_product:.2} cycles for each product of {} skins, everything counted; at most {ms:.2} ms",
        found.iter().map(|found| found.0).fold(f64::INFINITY, f64::min),
        found.len()
    ))
}

/// Without them the firmware is but a little slower by the emulator's timing; how much on a chip is open.
fn flash_accelerates(rig: &Rig) -> Result<String, Failure> {
    rig.link()?;
    let [prefetch, instructions, data] =
        rig.emulated_rig().board.with(|machine| machine.chip(|chip| chip.flash.accelerates()));
    ensure(prefetch && instructions && data, || {
        format!("prefetch {prefetch}, cache of instructions {instructions}, of data {data}")
    })?;
    Ok(String::new())
}

fn kernel_cycles(rig: &Rig) -> Result<String, Failure> {
    link::upload(&mut rig.link()?, &patches::patch(812, true, 13), |_| ())?;
    let virtual_rig = rig.emulated_rig();
    let other = virtual_rig.elf.with_file_name("kernel_cycles");
    let firmware = Arc::new(Firmware::load(&other).map_err(Failure::wrong)?);
    virtual_rig.program(firmware.clone())?;
    rig.wait(Duration::from_secs(1))?;
    let log = Log::new(&firmware).map_err(Failure::wrong)?;
    let lines = LogReader::new(&log, false).lines(&virtual_rig.board).map_err(Failure::wrong)?;
    let says = |words: &str| lines.iter().any(|line| line.contains(words));
    ensure(says("812 pixels x 104 measurements") && says("same bits: true"), || lines.join(" | "))?;
    Ok(lines.join(" | "))
}

/// More than the line carries: the board drops what it has no room for, and sends health ahead of images.
fn full_line(rig: &Rig) -> Result<String, Failure> {
    let mut link = rig.link()?;
    link::upload(&mut link, &patches::patch(812, true, 15), |_| ())?;
    link.request(&Request::Drive(Some(Drive::new(100e3, 1e-3, 1e4))))?;
    link::tare(&mut link, 2, Duration::from_secs(20))?;
    let mut stream = link.subscribe(Selection { images: 1, health: 4, ..Selection::default() })?;
    let mut images = 0;
    for _ in 0..FRAMES / 5 {
        images += usize::from(next_frame(&mut stream)?.image.is_some());
    }
    let (totals, lost) = (stream.totals(), stream.link().events_lost());
    stream.stop()?;
    let missing = totals.parts_missing + totals.frames_missing;
    ensure(missing > 0, || "the line carries it all, so nothing was tried".to_owned())?;
    ensure(images >= FRAMES / 20, || format!("{images} of {} frames have an image", totals.frames))?;
    ensure(totals.parts_unused == 0, || format!("{} parts came too late", totals.parts_unused))?;
    // Of a frame of which nothing came it is the image. What is read ahead may have gaps too.
    ensure((missing..missing + 50).contains(&lost), || {
        format!("{lost} events are lost, {missing} parts missing")
    })?;
    Ok(format!("{images} images in {} frames, {missing} parts dropped by the board", totals.frames))
}

/// Upload, tare, stream and reset on two boards.
fn repeats(rig: &Rig) -> Result<String, Failure> {
    let session = || -> Result<u64, Failure> {
        let rig = rig.fresh()?;
        compare_on(&rig, &patches::patch(64, true, 14), 10)?;
        rig.emulated().with(Machine::press_reset)?;
        rig.link()?.info()?;
        Ok(rig.emulated().with(|machine| machine.chip(|chip| chip.trace.hash())))
    };
    let (first, second) = (session()?, session()?);
    ensure(first == second, || format!("{first:016x} and {second:016x}"))?;
    Ok(format!("hash {first:016x}"))
}

fn images(rig: &Rig) -> Result<String, Failure> {
    let kinds = [
        (patches::patch(64, true, 11), FRAMES / 2),
        (patches::patch(25, false, 12), FRAMES / 4),
        // Values that saturate take another way through the kernel.
        (patches::with(33, true, 17, -12..18, 11), FRAMES / 4),
    ];
    let mut compared = 0;
    for (patch, frames) in kinds {
        compared += compare_on(rig, &patch, frames)?;
    }
    ensure(compared == FRAMES, || format!("{compared} of {FRAMES} images came"))?;
    Ok(format!("{compared} images"))
}

fn compare_on(rig: &Rig, patch: &[u8], frames: usize) -> Result<usize, Failure> {
    let mut link = rig.link()?;
    link::upload(&mut link, patch, |_| ())?;
    let view = PatchView::validate(patch).map_err(Failure::wrong)?;
    compare(&mut link, &view, frames, || ())
}

/// Images and contacts of the patch on the board are the host's; `press` is called after the tare.
pub(super) fn compare(
    link: &mut Link,
    view: &PatchView<'_>,
    frames: usize,
    press: impl FnOnce(),
) -> Result<usize, Failure> {
    let (mut state, mut ahead) = (PipelineState::default(), None);
    let all = Selection { images: 1, contacts: 1, measurements: 1, ..Selection::default() };
    let mut stream = link.subscribe(all)?;
    let first = tare(&mut stream, view, &mut state)?;
    check(view, &mut state, &mut ahead, &first)?;
    press();
    for _ in 1..frames {
        check(view, &mut state, &mut ahead, &next_frame(&mut stream)?)?;
    }
    ensure_complete(&mut stream)?;
    stream.stop()?;
    Ok(frames)
}

/// The host makes the same of a frame's codes as the board did, whose contacts' numbers are `ahead` of the host's:
/// a board never gives a number twice, the host's count begins with each patch. The first contact tells by how much.
fn check(
    view: &PatchView<'_>,
    state: &mut PipelineState,
    ahead: &mut Option<u32>,
    of_board: &ScanFrame,
) -> Result<(), Failure> {
    let ScanFrame { at: Some(at), measurements: Some(measurements), image: Some(image), contacts, .. } =
        of_board
    else {
        return Err(Failure::wrong(format!("of a frame, parts are missing: {:?}", of_board.missing)));
    };
    let outcome = pipeline::process(view, state, &frame(*at, measurements));
    ensure(outcome == Outcome::Image, || "no image here".to_owned())?;
    ensure(PackedImage::pack(state.image()) == *image, || format!("image {} differs", at.sequence))?;
    let mut contacts = contacts.clone();
    let first = |contacts: &Contacts| Some(contacts.first()?.identity?.number);
    *ahead = ahead.or_else(|| Some(first(contacts.as_ref()?)?.wrapping_sub(first(state.contacts())?)));
    for contact in contacts.iter_mut().flatten() {
        count_from(&mut contact.identity, ahead.unwrap_or(0));
    }
    ensure(contacts.as_ref() == Some(state.contacts()), || {
        format!("contacts of frame {} differ", at.sequence)
    })
}

/// All numbers in an identity, less this one.
fn count_from(identity: &mut Option<Identity>, first: u32) {
    if let Some(Identity { number, merged, split_from, .. }) = identity {
        for number in [Some(number), merged.as_mut(), split_from.as_mut()].into_iter().flatten() {
            *number = number.wrapping_sub(first);
        }
    }
}

/// Board and host average the same frames: the last without contacts before one that has them, which is given.
fn tare(
    stream: &mut Subscription<'_>,
    view: &PatchView<'_>,
    state: &mut PipelineState,
) -> Result<ScanFrame, Failure> {
    stream.link().request(&Request::Tare { frames: TARE_FRAMES })?;
    let mut frames = Vec::new();
    let first = loop {
        let scan = next_frame(stream)?;
        match (&scan.contacts, scan.at, &scan.measurements) {
            (None, Some(at), Some(measurements)) => frames.push(frame(at, measurements)),
            _ if frames.len() >= TARE_FRAMES.into() => break scan,
            // Those of an older reference.
            _ => frames.clear(),
        }
    };
    state.start_tare(TARE_FRAMES);
    for frame in &frames[frames.len() - usize::from(TARE_FRAMES)..] {
        pipeline::process(view, state, frame);
    }
    let Reply::Reference { sums, .. } = stream.link().request(&Request::Reference)? else {
        return Err(Failure::wrong("it gives no reference"));
    };
    let here = state.reference().map(|reference| reference.sums().to_vec());
    ensure(here.as_deref() == Some(&sums[..]), || "the references differ".to_owned())?;
    Ok(first)
}

fn frame(at: FrameStamp, measurements: &Measurements) -> Frame {
    let codes = measurements.codes.iter().copied().collect();
    Frame { sequence: at.sequence, timestamp_us: at.timestamp_us, flags: at.flags, codes, ..Frame::default() }
}
