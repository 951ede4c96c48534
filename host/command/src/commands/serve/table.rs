//! Table: all skins of a body, for people.

use dermatome_body::{Report, Sense, keeper::Phase};
use dermatome_link::{contacts::LinkReflexes, words::escaped};
use std::fmt::Write;

/// All skins, a line each.
pub(in crate::commands) fn table(body: &str, senses: &[Sense]) -> String {
    let width = senses.iter().map(|sense| sense.name.len()).max().unwrap_or(0).max("patch".len());
    let mut text = format!(
        "{body}\n{:width$}  {:10}  {:>8}  {:>7}  {:>9}  contacts\n",
        "patch", "state", "frames", "missing", "force, N"
    );
    for sense in senses {
        let Sense { name, state, frames, missing, report, .. } = sense;
        let force = report.as_ref().and_then(Report::wrench);
        let force = force.map_or("-".to_owned(), |wrench| {
            format!("{:.2}", wrench.force.iter().map(|part| part * part).sum::<f64>().sqrt())
        });
        let contacts = match report {
            Some(report) if report.at.flags.0 != 0 => {
                let flags: Vec<&str> = report.at.flags.words().collect();
                format!("{}  ({})", report.contacts.len(), flags.join(", "))
            }
            Some(report) => report.contacts.len().to_string(),
            None => escaped(&state.text),
        };
        let tripped =
            sense.reflexes.as_ref().map(LinkReflexes::from).map_or(String::new(), |now| match now {
                LinkReflexes { blind: true, .. } => "  reflexes blind".to_owned(),
                LinkReflexes { tripped, .. } if tripped.is_empty() => String::new(),
                LinkReflexes { tripped, .. } => format!("  reflexes {tripped:?} tripped"),
            });
        let phase = word(state.phase);
        // Writing to a string never fails.
        let _ = writeln!(
            text,
            "{name:width$}  {phase:10}  {frames:8}  {missing:7}  {force:>9}  {contacts}{tripped}"
        );
    }
    text
}

/// What became of a skin, for the end.
pub(super) fn summary(sense: &Sense) -> String {
    let Sense { name, state, frames, missing, losses, .. } = sense;
    let mut text = format!("{name}: {frames} frames, {missing} missing, lost {losses} times");
    if let Some(jitter) = sense.jitter() {
        let ms = |ns: u64| ns as f64 * 1e-6;
        let _ = write!(
            text,
            ", frames up to {:.1} ms late (middle one {:.2} ms), clock {:.0} ppm slow",
            ms(jitter.largest_ns),
            ms(jitter.median_ns),
            jitter.skew * 1e6
        );
    }
    if state.phase != Phase::Live {
        let _ = write!(text, "; {}: {}", word(state.phase), escaped(&state.text));
    }
    text
}

fn word(phase: Phase) -> &'static str {
    match phase {
        Phase::NoBoard => "no board",
        Phase::Lost => "lost",
        Phase::NoPatch => "no patch",
        Phase::OtherPatch => "other patch",
        Phase::NotTared => "not tared",
        Phase::Taring => "taring",
        Phase::Live => "live",
        Phase::Ended => "ended",
    }
}
