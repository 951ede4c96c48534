//! A board by itself.

use super::{
    super::fingers::Fingers,
    program::{accept, read, write_all},
};
use dermatome_hil::{
    board::{VirtualBoard, take_sent},
    chip::{time::Time, usart::Symbol},
    fault::Schedule,
    probe::emulated::LogReader,
};
use std::{
    error::Error,
    net::{TcpListener, TcpStream},
    process::ExitCode,
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

/// Virtual time between two polls of the connection.
const SLICE: Time = Time::from_millis(1);
/// The same of a board that is behind the clock on the wall, which has no time for more polls.
const SLICE_BEHIND: Time = Time::from_millis(5);

/// A board, and what goes on beside it.
pub(super) struct Served<'a> {
    pub(super) board: VirtualBoard,
    pub(super) faults: Arc<Mutex<Schedule>>,
    pub(super) log: Option<LogReader<'a>>,
    pub(super) fingers: Option<Fingers>,
}

/// Runs the board for ever, at the pace of the clock on the wall, and carries its bytes to and from a program.
pub(super) fn serve(listener: &TcpListener, mut served: Served<'_>) -> Result<ExitCode, Box<dyn Error>> {
    listener.set_nonblocking(true)?;
    let (start, wall) = (served.board.with(|machine| machine.now()), Instant::now());
    let mut client: Option<TcpStream> = None;
    let mut slice = SLICE;
    loop {
        if client.is_none() {
            client = accept(listener)?;
            if client.is_some() {
                served.board.open_port();
            }
        }
        let Served { board, faults, log, fingers } = &mut served;
        let (now, sent) = run_slice(board, faults, slice)?;
        for line in log.as_mut().map_or(Ok(Vec::new()), |log| log.lines(board))? {
            eprintln!("{line}");
        }
        if let Some(fingers) = fingers {
            fingers.hear_board(&sent);
        }
        if let Some(stream) = &mut client
            && (!exchange(stream, board, &sent, fingers.as_mut()) || board.has_lost_port())
        {
            client = None;
            board.hang_up();
            fingers.iter_mut().for_each(Fingers::lose_host);
        }
        let ahead = Duration::from_secs_f64(now.since(start).seconds()).saturating_sub(wall.elapsed());
        slice = if ahead.is_zero() { SLICE_BEHIND } else { SLICE };
        std::thread::sleep(ahead);
    }
}

/// Lets the board run for a while; gives its time and what it has sent, and prints what went wrong.
fn run_slice(
    board: &VirtualBoard,
    faults: &Arc<Mutex<Schedule>>,
    slice: Time,
) -> Result<(Time, Vec<u8>), Box<dyn Error>> {
    let schedule = faults.clone();
    let (now, sent, happened) = board.with(move |machine| {
        let deadline = machine.now() + slice;
        let happened = schedule.lock().unwrap_or_else(PoisonError::into_inner).run(machine, deadline);
        (machine.now(), take_sent(machine), happened)
    });
    for (time, what) in happened? {
        say!("{:>12.3} s  {what}", time.seconds());
    }
    Ok((now, sent))
}

/// Carries bytes between a program and the board; says whether the program is still there.
fn exchange(
    stream: &mut TcpStream,
    board: &VirtualBoard,
    sent: &[u8],
    fingers: Option<&mut Fingers>,
) -> bool {
    let Some(asked) = read(stream) else { return false };
    fingers.into_iter().for_each(|fingers| fingers.hear_host(&asked));
    board.send(Symbol::undamaged(&asked));
    write_all(stream, sent).is_ok()
}
