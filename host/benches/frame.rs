//! One frame through the board's code on this machine, one core; and the stages of `build`.
//!
//! `cargo bench -p dermatome`

use dermatome::{
    model::Model,
    simulate::{Noise, Rig, Script, SimulatedSkin, instrument::Instrument, rig::Observer},
    skin::Skin,
};
use dermatome_shared::{
    device::{Arrival, BoardFacts, Device, PatchStore, StoreError},
    frame::Frame,
    pipeline::PipelineState,
    protocol::{
        BoardPacket, FrameSource, Identity, MAX_PACKET_BYTES, Request, RequestPacket, Selection, encode,
    },
    restart::Restart,
};
use divan::{Bencher, black_box, counter::ItemsCount};
use std::path::Path;

fn main() {
    divan::main();
}

fn skin() -> Skin {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/disc-210mm/skin.toml");
    Skin::load(&path).expect("the shipped skin is valid").made().expect("the shipped skin is valid")
}

/// Holds one patch and takes no other.
struct Fixed(Vec<u8>);

impl PatchStore for Fixed {
    fn active(&self) -> Option<&[u8]> {
        Some(&self.0)
    }
    fn begin(&mut self, _: usize) -> Result<(), StoreError> {
        Err(StoreError::Unsupported)
    }
    fn append(&mut self, _: &[u8]) -> Result<(), StoreError> {
        Err(StoreError::Unsupported)
    }
    fn staged(&self) -> &[u8] {
        &[]
    }
    fn commit(&mut self) -> Result<(), StoreError> {
        Err(StoreError::Unsupported)
    }
}

/// A tared device that streams what `selection` says, and a frame of a pressed skin.
fn device(selection: Selection) -> (Device<Fixed>, Frame) {
    let skin = skin();
    let observer = Observer::new(&skin).expect("the shipped skin has a patch");
    let noise = Noise { snr_db: 60.0, seed: 1 };
    let simulated = SimulatedSkin::new(&skin, Script::round(skin.shape.flat().unwrap()), noise)
        .expect("and a simulation");
    let front_end = simulated.front_end();
    let mut rig = Rig::of(simulated, &observer.patch());
    let mut frame = |time| Frame { codes: rig.play(time).codes, ..Frame::default() };
    let identity = Identity { board: Default::default(), firmware: Default::default() };
    let (frame_source, started_after) = (FrameSource::Simulated, Restart::PowerOn);
    let facts =
        BoardFacts { identity, electrodes: 16, frame_source, front_end, started_after, sees_host_go: true };
    let mut device = Device::new(facts, Fixed(observer.patch_bytes().to_vec()), PipelineState::default());
    device.handle(&RequestPacket { sequence: 1, request: Request::Tare { frames: 1 } }, 0);
    device.process(&mut frame(None), &Arrival::default(), |_| ());
    device.handle(&RequestPacket { sequence: 2, request: Request::Stream(selection) }, 0);
    (device, frame(Some(1.0)))
}

/// 104 measurements x 812 pixels: reference, matrix and contacts, events made but not encoded.
#[divan::bench]
fn device_image_and_contacts(bencher: Bencher) {
    let (mut device, mut frame) = device(Selection { images: 1, contacts: 1, ..Selection::default() });
    bencher.counter(ItemsCount::new(1_u32)).bench_local(|| {
        device.process(black_box(&mut frame), &Arrival::default(), |event| _ = black_box(event));
    });
}

/// The same, with every event encoded into packets as it would be for the link.
#[divan::bench]
fn device_image_and_contacts_encoded(bencher: Bencher) {
    let (mut device, mut frame) = device(Selection { images: 1, contacts: 1, ..Selection::default() });
    let mut buffer = [0; MAX_PACKET_BYTES];
    let mut send = |event: &BoardPacket| {
        let _ = black_box(encode(event, &mut buffer));
    };
    bencher
        .counter(ItemsCount::new(1_u32))
        .bench_local(|| device.process(black_box(&mut frame), &Arrival::default(), &mut send));
}

/// Skin to reconstruction matrix, 3,940 elements.
#[divan::bench(sample_count = 20)]
fn model_of_disc(bencher: Bencher) {
    let skin = skin();
    bencher.bench_local(|| Model::build(black_box(&skin), |_| ()).expect("the shipped skin has a model"));
}
