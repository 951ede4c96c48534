//! Wrong and unusual inputs: every option of every command, every field of a skin file, every column of each table,
//! every file in many wrong forms, the port of a simulated board, and boards that misbehave.
//!
//! Each is a process of its own, in a folder of its own, with a time limit. It must be refused in words that name what
//! was wrong: the words are those of the case, made with it. It must not panic, and leave all files as they were.
#![cfg(unix)]

mod boards;
mod case;
mod files;
mod options;
mod port;
#[path = "../program/mod.rs"]
mod program;
mod skins;
mod tables;
#[path = "../testbench/mod.rs"]
mod testbench;
mod unusual;

use case::{Case, Desks, LIMIT, Outcome};
use std::{
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

/// Fewer would mean that a list has gone.
const LEAST: usize = 500;

#[test]
fn whatever_is_wrong_is_named_and_nothing_is_overwritten() {
    let desks = Desks::new();
    let lists: [(&str, Vec<Case>, usize); 6] = [
        ("options", options::cases(), 2),
        ("skin files", skins::cases(), 2),
        ("tables", tables::cases(&desks), 2),
        ("files", files::cases(&desks), 2),
        ("unusual", unusual::cases(&desks), 2),
        // Most of the time these wait for a board that says nothing.
        ("boards", boards::cases(), 12),
    ];
    let mut faults = Vec::new();
    let (mut count, mut slowest) = (0, (Duration::ZERO, String::new()));
    for (name, cases, threads) in lists {
        let start = Instant::now();
        let outcomes = run(&desks, &cases, threads);
        println!("{name}: {} in {:.1} s", cases.len(), start.elapsed().as_secs_f64());
        count += cases.len();
        for (case, Outcome { time, fault }) in cases.iter().zip(outcomes) {
            faults.extend(fault.map(|fault| format!("{name}: {case}\n{fault}")));
            if time > slowest.0 {
                slowest = (time, case.to_string());
            }
        }
    }
    let (messages, longest) = port::try_port();
    println!("bytes to the port: {messages}, answered again within {:.2} s", longest.as_secs_f64());
    count += messages;
    println!(
        "{count} cases, the slowest {:.2} s of {} s: {}",
        slowest.0.as_secs_f64(),
        LIMIT.as_secs(),
        slowest.1
    );
    assert!(faults.is_empty(), "{} of {count}:\n\n{}", faults.len(), faults.join("\n\n"));
    assert!(count >= LEAST, "{count}");
}

/// What becomes of each case, in their order.
fn run(desks: &Desks, cases: &[Case], threads: usize) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let at = next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = cases.get(at) else { return };
                    let outcome = desks.try_case(case);
                    done.lock().unwrap().push((at, outcome));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap();
    done.sort_by_key(|(at, _)| *at);
    done.into_iter().map(|(_, outcome)| outcome).collect()
}
