//! Firmware ELFs as `dermatome firmware` sees them: what may go to a board, and what must not.
#![cfg(unix)]

mod program;

use dermatome::link::program::firmware::{Fault, Firmware};
use insta::{Settings, assert_snapshot};
use program::{Desk, transcript};

/// The ARM and x86 of ELF's `e_machine`, and its types of an executable and an object file.
const ARM: u16 = 40;
const X86: u16 = 3;
const EXECUTABLE: u16 = 2;
const OBJECT: u16 = 1;

/// Where the chip's flash begins.
const FLASH: u32 = 0x0800_0000;

/// An ELF with one segment, code and data alike; what is wrong with it is changed in its fields.
#[derive(Clone)]
struct Elf {
    kind: u16,
    machine: u16,
    load_address: u32,
    content: Vec<u8>,
    /// How often the program headers name the segment.
    segments: u16,
}

impl Elf {
    /// The smallest firmware: a vector table, and one instruction that jumps to itself.
    fn sound() -> Self {
        Self {
            kind: EXECUTABLE,
            machine: ARM,
            load_address: FLASH,
            content: start(0x2002_0000, FLASH + 9),
            segments: 1,
        }
    }

    /// One with `length` bytes to program.
    fn of_length(length: usize) -> Self {
        let mut elf = Self::sound();
        elf.content.resize(length, 0xFF);
        elf
    }

    /// The file: header, one program header, content (System V ABI, chapters 4 and 5).
    fn bytes(&self) -> Vec<u8> {
        let length = u32::try_from(self.content.len()).unwrap();
        let halves = |values: &[u16]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>();
        let words = |values: &[u32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>();
        let identification = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0".to_vec();
        let (header, program_header) = (52, 32);
        let (load, read_and_execute) = (1, 5);
        let content_at = u32::from(header + self.segments * program_header);
        let segment =
            [load, content_at, self.load_address, self.load_address, length, length, read_and_execute, 4];
        [
            identification,
            halves(&[self.kind, self.machine]),
            words(&[1, FLASH + 9, u32::from(header), 0, 0x0500_0400]),
            halves(&[header, program_header, self.segments, 40, 0, 0]),
            words(&segment.repeat(self.segments.into())),
            self.content.clone(),
        ]
        .concat()
    }
}

/// Initial stack, reset vector, and `b .`
fn start(stack: u32, reset: u32) -> Vec<u8> {
    [&stack.to_le_bytes()[..], &reset.to_le_bytes(), &[0xFE, 0xE7]].concat()
}

fn refused(elf: &Elf) -> Fault {
    Firmware::new(elf.bytes()).unwrap_err()
}

#[test]
fn a_sound_firmware_goes_where_it_says() {
    let elf = Elf::of_length(600);
    let firmware = Firmware::new(elf.bytes()).unwrap();
    let [segment] = firmware.segments() else { panic!("{:?}", firmware.segments()) };
    assert_eq!((segment.address, &segment.bytes), (u64::from(FLASH), &elf.content));
    assert_eq!((firmware.size(), firmware.rtt_control_block()), (600, None));
}

#[test]
fn the_patch_slots_begin_where_the_firmwares_memory_ends() {
    let memory = include_str!("../../firmware/memory/nucleo-g474re.x");
    assert!(memory.contains("FLASH : ORIGIN = 0x08000000, LENGTH = 140K"), "{memory}");
    assert!(memory.contains("STACK : ORIGIN = 0x20000000, LENGTH = 30720"), "{memory}");
    assert!(memory.contains("RAM   : ORIGIN = 0x20007800, LENGTH = 100352"), "{memory}");
    assert!(Firmware::new(Elf::of_length(140 * 1024).bytes()).is_ok());
    let range = u64::from(FLASH)..0x0802_3001;
    assert_eq!(refused(&Elf::of_length(140 * 1024 + 1)), Fault::PatchSlots { range });
}

#[test]
fn the_flash_ends_after_512_kib() {
    let at = |load_address, length| refused(&Elf { load_address, ..Elf::of_length(length) });
    assert_eq!(at(0x0807_FF00, 0x100), Fault::PatchSlots { range: 0x0807_FF00..0x0808_0000 });
    assert_eq!(at(0x0807_FF00, 0x101), Fault::OutsideFlash { range: 0x0807_FF00..0x0808_0001 });
    assert_eq!(at(0x07FF_FFFF, 0x10), Fault::OutsideFlash { range: 0x07FF_FFFF..0x0800_000F });
    // An address so high that its end takes more than 32 bits.
    assert_eq!(at(0xFFFF_FFF8, 0x10), Fault::OutsideFlash { range: 0xFFFF_FFF8..0x1_0000_0008 });
}

#[test]
fn segments_lie_apart() {
    let range = u64::from(FLASH)..u64::from(FLASH) + 10;
    assert_eq!(refused(&Elf { segments: 2, ..Elf::sound() }), Fault::Overlap { range });
}

#[test]
fn the_vector_table_must_start_the_core() {
    let with = |stack, reset| refused(&Elf { content: start(stack, reset), ..Elf::sound() });
    assert_eq!(with(0x2002_0004, FLASH + 9), Fault::Stack { stack: 0x2002_0004 });
    assert_eq!(with(0x2002_0008, FLASH + 9), Fault::Stack { stack: 0x2002_0008 });
    assert_eq!(with(0x2000_0000, FLASH + 9), Fault::Stack { stack: 0x2000_0000 });
    assert_eq!(with(0x2002_0000, FLASH + 8), Fault::Reset { reset: u64::from(FLASH + 8) });
    assert_eq!(with(0x2002_0000, FLASH + 11), Fault::Reset { reset: u64::from(FLASH + 11) });
    assert_eq!(refused(&Elf { load_address: FLASH + 4, ..Elf::sound() }), Fault::NoVectorTable);
    assert_eq!(refused(&Elf { content: vec![0; 7], ..Elf::sound() }), Fault::NoVectorTable);
    assert_eq!(refused(&Elf { content: Vec::new(), ..Elf::sound() }), Fault::Empty);
}

/// Every cut and every damaged byte of the headers is an answer, and never a panic.
#[test]
fn damaged_files_are_answered() {
    let sound = Elf::sound().bytes();
    for length in 0..sound.len() {
        assert!(Firmware::new(sound[..length].to_vec()).is_err(), "cut after {length} bytes");
    }
    for at in 0..sound.len() {
        for bit in 0..8 {
            let mut damaged = sound.clone();
            damaged[at] ^= 1 << bit;
            if let Ok(firmware) = Firmware::new(damaged) {
                assert!(firmware.size() <= sound.len(), "byte {at}, bit {bit}");
            }
        }
    }
}

#[test]
fn errors_of_firmware_files() {
    let desk = Desk::empty();
    let sound = Elf::sound();
    let files = [
        ("other-machine", Elf { machine: X86, ..sound.clone() }.bytes()),
        ("object-file", Elf { kind: OBJECT, ..sound.clone() }.bytes()),
        ("other-chip", Elf { load_address: 0x0001_0000, ..sound.clone() }.bytes()),
        ("large", Elf::of_length(200_000).bytes()),
        ("twice", Elf { segments: 2, ..sound.clone() }.bytes()),
        ("no-table", Elf { load_address: FLASH + 0x100, ..sound.clone() }.bytes()),
        ("stack", Elf { content: start(0, FLASH + 9), ..sound.clone() }.bytes()),
        ("reset", Elf { content: start(0x2002_0000, 0), ..sound.clone() }.bytes()),
        ("nothing", Elf { content: Vec::new(), ..sound.clone() }.bytes()),
        ("cut", sound.bytes()[..90].to_vec()),
        ("text", b"a shopping list".to_vec()),
        ("empty", Vec::new()),
    ];
    for (name, bytes) in &files {
        desk.write(name, bytes);
    }
    let mut commands =
        vec![vec!["firmware"], vec!["firmware", "--elf", "missing"], vec!["firmware", "--elf", "."]];
    commands.extend(files.iter().map(|(name, _)| vec!["firmware", "--elf", *name]));
    let commands: Vec<_> = commands.iter().map(|arguments| &arguments[..]).collect();
    let words = transcript(&desk, &commands);
    let mut settings = Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(|| assert_snapshot!("errors_firmware", words));
}

/// A 64-bit program of this very machine: the test itself.
#[test]
fn a_program_of_this_machine_is_for_another_architecture() {
    let this = std::env::current_exe().unwrap();
    let words = Desk::empty().run(&["firmware", "--elf", this.to_str().unwrap()]).refused();
    if cfg!(target_os = "linux") {
        assert!(words.contains("is built for") && words.contains("32-bit Arm"), "{words}");
    }
}

#[cfg(not(feature = "probe"))]
#[test]
fn without_debug_probes_the_command_says_how_to_get_them() {
    let desk = Desk::empty();
    desk.write("sound", Elf::sound().bytes());
    let words = desk.run(&["firmware", "--elf", "sound", "--json", "report.json"]).refused();
    assert_eq!(
        words,
        "error: `sound` is sound (10 bytes to program), but this `dermatome` was built without debug probes; \
         in a checkout, run `cargo run --release --features probe -- firmware`, or install it with `cargo \
         install --path host --features probe`\n"
    );
    assert_eq!(desk.files(), ["sound"], "no report of what did not happen");
}

/// Where no probe is plugged in. With one, the test would program it, so it asks for one that cannot be.
#[cfg(feature = "probe")]
#[test]
fn a_probe_that_is_not_there_is_an_error() {
    let desk = Desk::empty();
    desk.write("sound", Elf::sound().bytes());
    let words = desk.run(&["firmware", "--elf", "sound", "--probe", "no such probe"]).refused();
    let known = ["no debug probe found", "no debug probe has the ID `no such probe`"];
    assert!(known.iter().any(|start| words.contains(start)), "{words}");
}

#[cfg(feature = "probe")]
#[test]
fn a_firmware_without_a_log_is_refused_before_any_probe_is_asked() {
    let desk = Desk::empty();
    desk.write("sound", Elf::sound().bytes());
    let words = desk.run(&["firmware", "--elf", "sound", "--logs", "--probe", "no such probe"]).refused();
    assert!(words.contains("no log (no symbol `_SEGGER_RTT`)"), "{words}");
}
