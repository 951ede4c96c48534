//! Programs in C and C++ with the header and the static library, each a process of its own.

use super::{
    paced_board,
    testbench::{board_with, square_patch},
};
use dermatome::simulate::board::SimulatedBoard;
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Output},
    time::Instant,
};
use tempfile::TempDir;

/// Strict, as a controller's project may be.
const STRICT: &[&str] = &["-Wall", "-Wextra", "-Werror", "-pedantic", "-O1"];

/// The library as Cargo has just made it for this program: the newest, as another one may lie there of other features.
fn library() -> PathBuf {
    let folder = env::current_exe().unwrap().parent().unwrap().to_owned();
    let entries = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let is_library = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        name.starts_with("libdermatome_c") && name.ends_with(".a")
    };
    let newest =
        entries.filter(is_library).max_by_key(|path| fs::metadata(path).unwrap().modified().unwrap());
    newest.unwrap_or_else(|| panic!("no libdermatome_c.a in {}", folder.display()))
}

/// A program of `source`, made by this compiler.
struct Program {
    folder: TempDir,
}

impl Program {
    fn made(compiler: &str, more: &[&str], source: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut command = Command::new(compiler);
        command.args(more).arg("-I").arg(here.join("include")).arg("-o").arg(folder.path().join("program"));
        // As C++ the source too, but not the library.
        let language = if compiler == "c++" { "c++" } else { "c" };
        command.args(["-x", language]).arg(here.join(source)).args(["-x", "none"]).arg(library());
        let made = command.args(["-lpthread", "-ldl", "-lm"]).output().unwrap();
        let said = String::from_utf8_lossy(&made.stderr);
        assert!(made.status.success() && said.is_empty(), "{compiler} {more:?} {source}:\n{said}");
        Self { folder }
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(self.folder.path().join("program")).args(arguments).output().unwrap()
    }

    /// What it prints; it must succeed, and have nothing to complain of.
    fn out(&self, arguments: &[&str]) -> String {
        let Output { status, stdout, stderr } = self.run(arguments);
        let said = String::from_utf8_lossy(&stderr);
        assert!(status.success() && said.is_empty(), "{status}: {said}");
        String::from_utf8(stdout).unwrap()
    }
}

fn board() -> SimulatedBoard {
    board_with(&square_patch("sixteen", 16, 14, 100.0))
}

fn port(board: &SimulatedBoard) -> String {
    format!("tcp:{}", board.address())
}

/// The example shows contacts on its link, where the board has them on the skin: 80 mm higher, and upside down.
fn shows_contacts(program: &Program) {
    let board = board();
    let shown = program.out(&[&port(&board), "60"]);
    let mut lines = shown.lines();
    let first = lines.next().unwrap();
    assert!(
        first.starts_with("simulated, firmware ") && first.contains("skin sixteen, 16 electrodes"),
        "{first}"
    );
    assert_eq!(shown.matches("\nframe ").count(), 60, "{shown}");
    let contact = shown.lines().last().unwrap();
    assert!(contact.contains("at (5.0, -5.0, 80.0) mm, normal (0.00, 0.00, -1.00)"), "{contact}");
}

#[test]
fn the_example_is_strict_c99_and_shows_contacts_on_the_link() {
    let program = Program::made("cc", &[STRICT, &["-std=c99"]].concat(), "examples/contacts.c");
    shows_contacts(&program);
    let nothing = program.run(&["tcp:127.0.0.1:1"]);
    let said = String::from_utf8(nothing.stderr).unwrap();
    assert_eq!(nothing.status.code(), Some(1));
    assert!(said.starts_with("error -4: ") && said.contains("no board listens there"), "{said}");
    assert_eq!(program.run(&[]).status.code(), Some(2));
}

#[test]
fn the_example_is_cpp_too() {
    shows_contacts(&Program::made("c++", &[STRICT, &["-std=c++11"]].concat(), "examples/contacts.c"));
}

/// Bytes beyond a record, and memory that is not given back, end the program with an error.
#[test]
fn the_example_leaves_no_memory_behind_and_none_of_others_is_touched() {
    if !has_sanitizer() {
        println!("the example with its memory watched: *not run*, this compiler has no address sanitizer");
        return;
    }
    let watched = ["-std=c99", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    shows_contacts(&Program::made("cc", &watched, "examples/contacts.c"));
}

fn has_sanitizer() -> bool {
    let folder = tempfile::tempdir().unwrap();
    let (source, program) = (folder.path().join("empty.c"), folder.path().join("empty"));
    fs::write(&source, "int main(void) { return 0; }\n").unwrap();
    let made =
        Command::new("cc").arg("-fsanitize=address,undefined").arg(source).arg("-o").arg(&program).output();
    made.is_ok_and(|made| made.status.success()) && Command::new(program).output().unwrap().status.success()
}

/// Counted in C, by what the linker puts in the place of malloc and its like.
#[test]
fn a_loop_in_c_allocates_nothing_and_is_the_only_thread() {
    let wrap = ["malloc", "calloc", "realloc", "posix_memalign", "aligned_alloc"]
        .map(|name| format!("-Wl,--wrap={name}"));
    let mut more = vec!["-std=c99"];
    more.extend(wrap.iter().map(String::as_str));
    more.extend(STRICT);
    let program = Program::made("cc", &more, "tests/c/loop.c");
    let board = paced_board(2000.0);
    let said = program.out(&[&port(&board), "3000"]);
    assert!(said.starts_with("3000 frames, "), "{said}");
    assert!(said.contains("0 allocations in the loop") && said.contains("1 thread\n"), "{said}");
    let setting_up: u64 = said.rsplit("after ").next().unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(setting_up > 10, "allocations are not counted: {said}");
}

#[test]
fn records_and_codes_are_in_c_what_they_are_here() {
    let program = Program::made("cc", &[STRICT, &["-std=c99"]].concat(), "tests/c/records.c");
    use dermatome_c::records::*;
    let sizes = [
        size_of::<Identity>(),
        size_of::<Skin>(),
        size_of::<Drive>(),
        size_of::<Pixel>(),
        size_of::<Pose>(),
        size_of::<Options>(),
        size_of::<Contact>(),
        size_of::<Counts>(),
        size_of::<Frame>(),
        std::mem::offset_of!(Frame, contacts),
        std::mem::offset_of!(Contact, strength_deviation),
        std::mem::offset_of!(Skin, drive),
    ];
    assert_eq!(program.out(&[]), sizes.map(|size| format!("{size}\n")).concat());
}

#[test]
fn a_paced_board_is_waited_for_without_turning_in_circles() {
    let board = paced_board(50.0);
    let program = Program::made("cc", &["-std=c99"], "tests/c/wait.c");
    let begun = Instant::now();
    let said = program.out(&[&port(&board), "50"]);
    let took = begun.elapsed();
    let turns: u64 = said.split(' ').next().unwrap().parse().unwrap();
    // Each turn waits 5 ms or gets a frame.
    let most = 50 + took.as_millis() as u64 / 5;
    assert!((50..=most).contains(&turns), "{said} in {took:?}");
}
