//! Against Arm's own examples and tables (100166_0001).

use super::*;

struct Code(&'static [u16], u32);

impl Core for Code {
    fn code(&self, _: u32, _: u32) -> Vec<u8> {
        self.0.iter().flat_map(|halfword| halfword.to_le_bytes()).collect()
    }
    fn register(&self, _: usize) -> u32 {
        self.1
    }
}

/// Where no wait states are.
const RAM: u32 = 0x2000_0000;

/// Cycles of code, from the optimistic to the pessimistic.
fn cycles(code: &'static [u16]) -> (u64, u64) {
    let of = |timing| {
        let mut counter = Counter::new(timing);
        // As if it followed what is before.
        counter.follows = RAM;
        counter.run(RAM, 2 * code.len() as u32, &Code(code, RAM)).0
    };
    (of(Timing::OPTIMISTIC), of(Timing::PESSIMISTIC))
}

#[test]
fn loads_and_stores_take_what_the_manual_s_examples_say() {
    // ldr r0, [r1]; ldr r1, [r2] - normally three cycles total.
    assert_eq!(cycles(&[0x6808, 0x6811]), (3, 3));
    // ldr r0, [r1, r2]; str r0, [r3, #20] - normally three.
    assert_eq!(cycles(&[0x5888, 0x6158]), (3, 3));
    // ldr r0, [r1, r5]; ldr r1, [r2]; ldr r2, [r3, #4] - normally four.
    assert_eq!(cycles(&[0x5948, 0x6811, 0x685A]), (4, 4));
    // ldr r0, [r1]; ldr r2, [r0]: the address is that of the first.
    assert_eq!(cycles(&[0x6808, 0x6802]), (4, 4));
    // str r0, [r1] alone: always one, or two.
    assert_eq!(cycles(&[0x6008]), (1, 2));
    // adds r1, #4; ldr r0, [r1]: an address that was just computed costs a cycle more.
    assert_eq!(cycles(&[0x3104, 0x6808]), (4, 4));
}

#[test]
fn instructions_take_what_the_manual_s_table_says() {
    let known: [(&[u16], (u64, u64)); 12] = [
        // ldm r0!, {r4-r7}; push {r4-r7, lr}; ldrd r0, r1, [r2].
        (&[0xC8F0], (5, 5)),
        (&[0xB5F0], (6, 6)),
        (&[0xE9D2, 0x0100], (3, 3)),
        // mul r0, r1, r0; mla r0, r1, r2, r3; smlald r2, r3, r4, r8; udiv r0, r1, r2.
        (&[0x4348], (1, 1)),
        (&[0xFB01, 0x3002], (2, 2)),
        (&[0xFBC4, 0x23C8], (1, 1)),
        (&[0xFBB1, 0xF0F2], (2, 12)),
        // sxtb16 r4, r5; movs r0, #1; it eq with moveq r0, r1.
        (&[0xFA2F, 0xF485], (1, 1)),
        (&[0x2001], (1, 1)),
        (&[0xBF08, 0x4608], (1, 2)),
        // vmul.f32 s0, s1, s2, then vadd.f32 s3, s0, s1 waits for it; vdiv.f32 s0, s1, s2.
        (&[0xEE20, 0x0A81, 0xEE70, 0x1A20], (3, 3)),
        (&[0xEE80, 0x0A81], (14, 14)),
    ];
    for (code, expected) in known {
        assert_eq!(cycles(code), expected, "{code:04x?}");
    }
}

#[test]
fn a_branch_that_is_taken_refills_the_pipeline() {
    // b somewhere, and the code there.
    let mut counter = Counter::new(Timing::PESSIMISTIC);
    counter.follows = RAM;
    assert_eq!(counter.run(RAM, 2, &Code(&[0xE7FF], 0)).0, 1);
    assert_eq!(counter.run(RAM + 64, 2, &Code(&[0x2001], 0)).0, 1 + 3);
    assert_eq!(counter.run(RAM + 66, 2, &Code(&[0x2001], 0)).0, 1);
}

#[test]
fn words_that_lie_askew_in_a_run_take_longer() {
    // ldr r10, [r1], #4, three times.
    let code: &[u16] = &[0xF851, 0xAB04, 0xF851, 0xAB04, 0xF851, 0xAB04];
    let of = |start| {
        let mut counter = Counter::new(Timing::PESSIMISTIC);
        counter.follows = RAM;
        counter.run(RAM, 12, &Code(code, start)).0
    };
    assert_eq!([RAM, RAM + 2, RAM + 1].map(of), [4, 4 + 3, 4 + 6]);
    // mov r1, r5 ahead of it: where r1 was at first says nothing.
    assert_eq!(cycles(&[0x4629, 0xF851, 0xAB04]), (4, 4));
    let mut counter = Counter::new(Timing::PESSIMISTIC);
    counter.follows = RAM;
    assert_eq!(counter.run(RAM, 6, &Code(&[0x4629, 0xF851, 0xAB04], RAM + 1)).0, 4);
}

#[test]
fn code_in_the_flash_waits_for_it_once() {
    let start = START + 0x400;
    let mut counter = Counter::new(Timing::PESSIMISTIC);
    counter.set_up(Access { latency: 4, caches_instructions: true, ..Access::default() });
    // Ten movs, in three double words.
    let code = Code(&[0x2001; 10], 0);
    let mut run = || {
        counter.follows = start;
        counter.run(start, 20, &code).0
    };
    assert_eq!([run(), run()], [10 + 3 * 4, 10]);
}

#[test]
fn blocks_say_what_else_they_do() {
    let effects = |code: &[u16]| {
        let bytes: Vec<u8> = code.iter().flat_map(|halfword| halfword.to_le_bytes()).collect();
        instructions::effects(&bytes)
    };
    assert!(effects(&[0xE7FE]).is_circle && !effects(&[0x2001, 0xE7FE]).is_circle);
    assert!(effects(&[0x2001, 0xBF40]).sends_event);
    // The second half of a long instruction is no SEV.
    assert_eq!(effects(&[0xF851, 0xBF40]), Effects::default());
    assert!(effects(&[0xBF08, 0x4608]).has_conditions && !effects(&[0xBF00]).has_conditions);
}
