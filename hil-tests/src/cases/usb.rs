//! Cases of a board on USB: what its host sees of it, and what becomes of the board when cable, bus or host do not behave.

use super::{Case, Failure, ensure};
use crate::{
    chip::{
        time::Time,
        usb::host::{Host, Refused, Request},
    },
    machine::Machine,
    rig::{Capability, Rig},
};
use std::time::Duration;

const NEEDS: &[Capability] = &[Capability::Usb];

pub(super) const CASES: &[Case] =
    &[Case { name: "a host enumerates the board by the rules", needs: NEEDS, run: enumerates }];

/// Does something with the host.
fn host<T: Send + 'static>(rig: &Rig, act: impl FnOnce(&mut Host, Time) -> T + Send + 'static) -> T {
    rig.emulated().with(|machine: &mut Machine| {
        let now = machine.now();
        machine.chip(|chip| act(chip.usb.host_mut(), now))
    })
}

fn enumerates(rig: &Rig) -> Result<String, Failure> {
    rig.wait(Duration::from_millis(1000))?;
    let (problems, described) = host(rig, |host, _| (host.problems().to_vec(), host.described().clone()));
    println!("{problems:?} {described:?} {:?}", host(rig, |host, _| format!("{host:?}")));
    Ok(String::new())
}
