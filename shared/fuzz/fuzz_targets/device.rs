//! Any sequence of requests with frames in between: the board never panics, replies to each request
//! once and with its number, numbers its events without gaps, and holds only patches that are valid.
#![no_main]

use arbitrary::Arbitrary;
use dermatome_shared::{
    device::{Arrival, BoardFacts, Device, PatchStore, StoreError},
    patch::PatchView,
    pipeline::{PipelineState, reflex::Watch},
    protocol::{
        BoardPacket, FrameSource, Identity, MAX_CHUNK_BYTES, Reply, Request, RequestPacket, Selection,
        Version,
    },
    restart::Restart,
};
use dermatome_shared_fuzz::{damage, frame, small_patch};
use libfuzzer_sys::fuzz_target;

/// What a host, or the world, does next.
#[derive(Arbitrary, Debug)]
enum Deed {
    Hello {
        right_version: bool,
    },
    Info,
    ReadPatch(u32),
    Reference,
    Begin {
        length: u32,
        crc: u32,
    },
    Chunk {
        offset: u16,
        bytes: Vec<u8>,
    },
    Commit,
    Tare {
        frames: u16,
    },
    /// A tare that is complete soon.
    ShortTare {
        frames: u8,
    },
    Stream {
        images: u16,
        contacts: u16,
        measurements: u16,
        health: u16,
    },
    /// A whole patch, damaged by these edits, checksum right.
    Upload {
        edits: Vec<u8>,
    },
    Disconnect,
    Frame {
        codes: [i32; 3],
        steps: u16,
    },
    /// A frame of as many codes as the patch has steps.
    RightFrame {
        codes: [i32; 3],
    },
    Restart,
}

/// Its writes fail once `writes_left` is used up.
struct Memory {
    active: Option<Vec<u8>>,
    staged: Vec<u8>,
    writes_left: u16,
}

impl Memory {
    fn write(&mut self) -> Result<(), StoreError> {
        self.writes_left = self.writes_left.checked_sub(1).ok_or(StoreError::Failed)?;
        Ok(())
    }
}

impl PatchStore for Memory {
    fn active(&self) -> Option<&[u8]> {
        self.active.as_deref()
    }
    fn begin(&mut self, _: usize) -> Result<(), StoreError> {
        self.write()?;
        self.staged.clear();
        Ok(())
    }
    fn append(&mut self, bytes: &[u8]) -> Result<(), StoreError> {
        self.write()?;
        self.staged.extend(bytes);
        Ok(())
    }
    fn staged(&self) -> &[u8] {
        &self.staged
    }
    fn commit(&mut self) -> Result<(), StoreError> {
        self.write()?;
        self.active = Some(std::mem::take(&mut self.staged));
        Ok(())
    }
}

struct Rig {
    device: Device<Memory, PipelineState>,
    watch: Watch,
    scan: Option<u32>,
    requests: u16,
    events: u32,
}

impl Rig {
    fn new(electrodes: u8, stored: Option<Vec<u8>>, writes_left: u16) -> Self {
        let identity = Identity { board: "fuzz".try_into().unwrap(), firmware: "0".try_into().unwrap() };
        let store = Memory { active: stored, staged: Vec::new(), writes_left };
        let (frame_source, started_after) = (FrameSource::Synthetic, Restart::PowerOn);
        let facts = BoardFacts {
            identity,
            electrodes,
            frame_source,
            front_end: None,
            started_after,
            sees_host_go: false,
        };
        let device = Device::new(facts, store, PipelineState::default());
        Self { device, watch: Watch::new(), scan: None, requests: 0, events: 0 }
    }

    fn ask(&mut self, request: Request) -> Reply {
        self.requests = self.requests.wrapping_add(1);
        match self.device.handle(&RequestPacket { sequence: self.requests, request }, 0) {
            BoardPacket::Reply { sequence, reply } if sequence == self.requests => reply,
            other => panic!("no reply to request {}: {other:?}", self.requests),
        }
    }

    fn upload(&mut self, bytes: &[u8]) {
        let before = self.device.patch().map(|patch| patch.crc());
        let crc = bytes.last_chunk().map_or(0, |crc| u32::from_le_bytes(*crc));
        self.ask(Request::BeginUpload { length: bytes.len() as u32, crc });
        for (i, chunk) in bytes.chunks(MAX_CHUNK_BYTES).enumerate() {
            self.ask(chunk_at(i * MAX_CHUNK_BYTES, chunk));
        }
        let done = self.ask(Request::CommitUpload) == Reply::Done;
        let now = self.device.patch().map(|patch| patch.crc());
        assert_eq!(now, if done { Some(crc) } else { before });
    }

    fn process(&mut self, codes: &[i32], steps: usize) {
        let streaming = self.device.streaming();
        let mut seen = Vec::new();
        if self.scan.replace(self.device.scan()) != Some(self.device.scan()) {
            self.device.begin_watch(&mut self.watch);
        }
        let mut frame = frame(steps, codes);
        let arrival = Arrival { reflexes: self.watch.see(&frame, 0), ..Arrival::default() };
        self.device.process(&mut frame, &arrival, |packet| seen.push(packet.clone()));
        self.device.brief(&mut self.watch);
        for packet in seen {
            let BoardPacket::Event { number, .. } = packet else { panic!("{packet:?} was not asked for") };
            assert_eq!(number, self.events);
            self.events += 1;
        }
        assert_eq!(self.device.streaming(), streaming);
    }

    fn steps(&self) -> usize {
        self.device.patch().map_or(0, |patch| patch.header.steps.into())
    }

    fn check(&self, electrodes: u8) {
        if let Some(patch) = self.device.patch() {
            let patch = PatchView::validate(patch.bytes()).expect("the patch in use is valid");
            assert!(patch.header.electrodes <= electrodes);
        }
    }
}

fn chunk_at(offset: usize, bytes: &[u8]) -> Request {
    let bytes = heapless::Vec::from_slice(&bytes[..bytes.len().min(MAX_CHUNK_BYTES)]).unwrap();
    Request::UploadChunk { offset: offset as u32, bytes }
}

#[derive(Arbitrary, Debug)]
struct Input {
    electrodes: u8,
    writes: u16,
    stored: Option<Vec<u8>>,
    deeds: Vec<Deed>,
}

fuzz_target!(|input: Input| {
    let electrodes = input.electrodes % 17;
    let mut rig = Rig::new(electrodes, input.stored, input.writes);
    for deed in input.deeds {
        match deed {
            Deed::Hello { right_version: true } => drop(rig.ask(Request::Hello(Version::current()))),
            Deed::Hello { right_version: false } => {
                drop(rig.ask(Request::Hello(Version { protocol: 999, schema: [1; 8] })));
            }
            Deed::Info => drop(rig.ask(Request::Info)),
            Deed::ReadPatch(offset) => drop(rig.ask(Request::ReadPatch { offset })),
            Deed::Reference => drop(rig.ask(Request::Reference)),
            Deed::Begin { length, crc } => drop(rig.ask(Request::BeginUpload { length, crc })),
            Deed::Chunk { offset, bytes } => drop(rig.ask(chunk_at(offset.into(), &bytes))),
            Deed::Commit => drop(rig.ask(Request::CommitUpload)),
            Deed::Tare { frames } => drop(rig.ask(Request::Tare { frames })),
            Deed::ShortTare { frames } => drop(rig.ask(Request::Tare { frames: u16::from(frames % 4) })),
            Deed::Stream { images, contacts, measurements, health } => {
                let selection = Selection { images, contacts, measurements, health, ..Selection::default() };
                drop(rig.ask(Request::Stream(selection)));
            }
            Deed::Upload { edits } => rig.upload(&damage(small_patch(), &edits)),
            Deed::Disconnect => rig.device.disconnect(),
            Deed::Frame { codes, steps } => rig.process(&codes, usize::from(steps % 300)),
            Deed::RightFrame { codes } => rig.process(&codes, rig.steps()),
            Deed::Restart => {
                let stored = rig.device.patch().map(|patch| patch.bytes().to_vec());
                rig = Rig::new(electrodes, stored, input.writes);
            }
        }
        rig.check(electrodes);
    }
});
