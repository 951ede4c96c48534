//! Tries.
use dermatome_hil::{elf::Image, machine::{Machine, Options}, chip::time::Time};
fn main() {
    let image = Image::read(std::path::Path::new(&std::env::args().nth(1).unwrap())).unwrap();
    let mut machine = Machine::new(&image, Options { keep_trace: true, ..Options::default() }).unwrap();
    let start = std::time::Instant::now();
    let result = machine.run_until(Time::from_millis(100));
    println!("{result:?} now {} instructions {} wall {:?}", machine.now(), machine.instructions(), start.elapsed());
    for (t, e) in machine.chip(|c| c.trace.take()).iter().take(40) { println!("{t} {e}"); }
}
