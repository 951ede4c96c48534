//! A loop's thread allocates nothing, counted by the allocator of this program.

use super::{
    handle::Handle,
    paced_board,
    testbench::cable::{Cable, Carries},
};
use dermatome_c::{
    codes::{DERMATOME_CUT, DERMATOME_FRAME, DERMATOME_OK, DERMATOME_PENDING},
    functions::dermatome_place,
    records::{Contact, Frame, Options, Pose},
};
use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
    mem::MaybeUninit,
};

#[global_allocator]
static COUNTED: Counted = Counted;

thread_local! {
    /// Allocations of this thread.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counted;

// SAFETY: the system's allocator does it; counting allocates nothing.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise.
        unsafe { System.realloc(memory, layout, size) }
    }
}

pub(crate) fn allocations(of: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.get();
    of();
    ALLOCATIONS.get() - before
}

const ALL: Options = Options { contacts_every: 1, images_every: 1, patch_crc: 0, silence_ms: 0 };

/// A turn of a controller: all that has come is taken, with its image and its contacts on the link.
struct Turn<'a> {
    board: &'a Handle,
    frame: MaybeUninit<Frame>,
    image: [f32; 1024],
    frames: u64,
    contacts: u64,
}

impl<'a> Turn<'a> {
    fn of(board: &'a Handle) -> Self {
        Self { board, frame: MaybeUninit::uninit(), image: [0.0; 1024], frames: 0, contacts: 0 }
    }

    /// Gives the last code.
    fn take(&mut self) -> i32 {
        loop {
            let code = self.board.poll(&mut self.frame);
            if code != DERMATOME_FRAME {
                return code;
            }
            // SAFETY: the code says that it was written.
            let frame = unsafe { self.frame.assume_init_ref() };
            self.frames += 1;
            self.contacts += u64::from(frame.contact_count);
            if frame.has_image == 1 {
                assert_eq!(self.board.image(&mut self.image), 196);
            }
            for contact in &frame.contacts[..frame.contact_count as usize] {
                place(contact);
            }
        }
    }
}

fn place(contact: &Contact) {
    let pose = Pose { position: [0.0, 0.0, 1.0], orientation: [0.0, 0.0, 0.0, 1.0] };
    let mut placed = Contact::default();
    // SAFETY: all of it lives here.
    let code = unsafe { dermatome_place(&raw const pose, contact, &raw mut placed, size_of::<Contact>()) };
    assert_eq!((code, placed.position[2]), (DERMATOME_OK, contact.position[2] + 1.0));
}

#[test]
fn thousands_of_frames_with_images_tares_and_drives_allocate_nothing() {
    let board = paced_board(2000.0);
    let mut opened = None;
    let setting_up = allocations(|| opened = Some(Handle::at(board.address())));
    assert!(setting_up > 0, "allocations are not counted");
    let handle = opened.unwrap();
    let drive = handle.skin().unwrap().drive;
    handle.start(ALL).unwrap();
    let mut turn = Turn::of(&handle);
    let (mut answers, mut tares) = (0, 0);
    let inside = allocations(|| {
        while turn.frames < 5000 {
            assert_eq!(turn.take(), DERMATOME_OK);
            let answer = handle.answer();
            assert!(answer >= 0, "{}", handle.error());
            if turn.frames > 1000 * answers && answer != DERMATOME_PENDING {
                answers += 1;
                if answers % 2 == 0 { handle.ask_tare(20) } else { handle.ask_drive(&drive) }.unwrap();
            }
            std::thread::yield_now();
        }
        tares = handle.counts().tares;
    });
    assert_eq!(inside, 0);
    assert!(turn.contacts > 100 && answers >= 4 && tares >= 2, "{} {answers} {tares}", turn.contacts);
}

#[test]
fn noise_on_the_cable_lost_frames_and_a_cut_allocate_nothing() {
    let board = paced_board(400.0);
    let cable = Cable::to(board.address());
    let handle = Handle::at(cable.address());
    handle.start(ALL).unwrap();
    let mut turn = Turn::of(&handle);
    let mut until = |frames: u64, code: i32| {
        let wanted = turn.frames + frames;
        allocations(|| {
            let mut last = DERMATOME_OK;
            while turn.frames < wanted && last != code {
                last = turn.take();
                std::thread::yield_now();
            }
        })
    };
    assert_eq!(until(100, DERMATOME_CUT), 0);
    cable.carry(Carries::Noise);
    assert_eq!(until(100, DERMATOME_CUT), 0);
    let counts = handle.counts();
    assert!(counts.packets_damaged > 10 && counts.events_lost > 0, "{counts:?}");
    cable.pull();
    assert_eq!(until(u64::MAX / 2, DERMATOME_CUT), 0);
    assert!(handle.error().contains("was cut"), "{}", handle.error());
}

/// A handle that goes to the thread that uses it from now on, as is allowed.
struct Given(Handle);

// SAFETY: nobody else uses it any more.
unsafe impl Send for Given {}

/// One that is too small ends this program.
#[test]
fn a_loop_runs_on_a_thread_with_a_stack_of_128_kib() {
    let board = paced_board(400.0);
    let given = Given(Handle::at(board.address()));
    given.0.start(ALL).unwrap();
    let run = move || {
        let Given(handle) = { given };
        let mut turn = Turn::of(&handle);
        while turn.frames < 200 {
            assert_eq!(turn.take(), DERMATOME_OK, "{}", handle.error());
            std::thread::yield_now();
        }
    };
    std::thread::Builder::new().stack_size(128 << 10).spawn(run).unwrap().join().unwrap();
}
