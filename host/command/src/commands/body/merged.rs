//! Merged: what all computers say, as lines or a table.

use crate::commands::{
    JsonReport,
    contact_lines::is_read,
    lines::Lines,
    network::Network,
    serve::{lines, table},
};
use anyhow::{Context, ensure};
use dermatome_body::asking::Outcome;
use dermatome_link::words::escaped;
use dermatome_messages::dermatome::DriveRequest;
use dermatome_view::terminal::Screen;
use dermatome_zenoh::{
    Listener, Merge, Settings,
    key::Space,
    merge::{Change, Finding, Totals},
};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Longest wait without looking for Ctrl-C.
const LOOK: Duration = Duration::from_millis(20);
/// How often the table is drawn.
const DRAWN: Duration = Duration::from_millis(500);

const NOBODY: &str = "no computer serves a robot's skins; run `dermatome serve --zenoh` there";

#[derive(Serialize)]
struct Report<'a> {
    body: &'a str,
    seconds: f64,
    patches: Vec<Totals>,
    findings: &'a [Finding],
    /// Of what came over the network, more than could be taken.
    messages_dropped: u64,
    /// Of lines that nobody read in time.
    lines_dropped: u64,
}

/// A body, and where its contacts go.
struct Merged {
    listener: Listener,
    merge: Merge,
    /// Standard output, unless it is a terminal.
    lines: Option<Lines>,
    screen: Screen,
    looked: Instant,
    drawn: Instant,
}

pub(super) fn run(
    name: Option<&str>,
    network: &Network,
    json: &JsonReport,
    is_over: impl Fn() -> bool,
) -> anyhow::Result<()> {
    let listener = Listener::open(name, &Settings::from(network), &is_over)?;
    let listener = listener.context(NOBODY)?;
    let screen = Screen::default();
    let lines = if screen.is_visible() { None } else { Some(Lines::start(lines::dropped)?) };
    let now = Instant::now();
    let mut merged = Merged { listener, merge: Merge::default(), lines, screen, looked: now, drawn: now };
    let ended = merged.hear(is_over);
    let written = merged.lines.as_mut().map_or(Ok(true), |lines| is_read(lines.end()));
    let totals = merged.merge.totals();
    let is_nobody = totals.is_empty();
    totals.iter().for_each(|totals| eprintln!("{}", summary(totals)));
    json.write(&Report {
        body: merged.listener.robot(),
        seconds: now.elapsed().as_secs_f64(),
        patches: totals,
        findings: merged.merge.findings(),
        messages_dropped: merged.listener.dropped(),
        lines_dropped: merged.lines.as_ref().map_or(0, Lines::dropped),
    })?;
    merged.listener.end();
    ended?;
    written?;
    ensure!(!is_nobody, "no computer serves skins of a robot of that name: it is the one in the body files");
    Ok(())
}

/// Asks skins of these names, or all, for a new reference or to be driven like that.
pub(super) fn ask(
    name: Option<&str>,
    patches: &[String],
    drive: Option<&DriveRequest>,
    network: &Network,
    is_over: impl Fn() -> bool,
) -> anyhow::Result<()> {
    let (mut asked, mut refused) = (0, 0);
    let tell = |space: &Space, outcome: Outcome| {
        asked += 1;
        let (patch, words) = (&space.patch, escaped(&outcome.message));
        if outcome.success {
            say!("{patch}: {words}");
        } else {
            refused += 1;
            eprintln!("{patch}: not done: {words}");
        }
    };
    dermatome_zenoh::ask(name, patches, drive, &Settings::from(network), is_over, tell)?;
    ensure!(asked > 0, NOBODY);
    ensure!(refused == 0, "{refused} of {asked} skins have not done it");
    Ok(())
}

impl Merged {
    /// Takes what is heard until it is to stop, or nobody reads any more.
    fn hear(&mut self, is_over: impl Fn() -> bool) -> anyhow::Result<()> {
        while !is_over() {
            let heard = self.listener.next(LOOK);
            let now = Instant::now();
            let mut changes = heard.map_or(Vec::new(), |heard| self.merge.take(heard, now));
            if now.duration_since(self.looked) >= LOOK {
                self.looked = now;
                changes.extend(self.merge.look(now));
            }
            for change in changes {
                if !self.tell(change)? {
                    return Ok(());
                }
            }
            self.tell_findings()?;
            if self.lines.is_none() && self.drawn.elapsed() >= DRAWN {
                self.drawn = now;
                self.screen.draw(&table::table(self.listener.robot(), self.merge.body().senses()))?;
            }
        }
        Ok(())
    }

    /// Tells what has changed; false if nobody reads any more.
    fn tell(&mut self, change: Change) -> anyhow::Result<bool> {
        let Some(lines) = &mut self.lines else { return Ok(true) };
        let body = self.merge.body();
        let line = match change {
            Change::State(index) => {
                lines.remark(&lines::state(&body.senses()[index])?);
                String::new()
            }
            Change::Frame(index) => {
                let sense = &body.senses()[index];
                lines::frame(sense, body.wrench(&sense.link))?
            }
        };
        Ok(is_read(lines.frame(line))?)
    }

    fn tell_findings(&mut self) -> anyhow::Result<()> {
        for finding in self.merge.take_findings() {
            let Finding { patch, link, finding: words } = finding;
            eprintln!("warning: `{patch}` on `{link}`: {}", escaped(words));
            if let Some(lines) = &mut self.lines {
                lines.remark(&serde_json::to_string(finding)?);
            }
        }
        Ok(())
    }
}

/// What became of a skin, for the end.
fn summary(totals: &Totals) -> String {
    let Totals { patch, computer, frames, frames_lost, losses, .. } = totals;
    let computer = escaped(computer);
    let mut text = format!(
        "{patch} of `{computer}`: {frames} frames, {frames_lost} lost on the way, lost {losses} times"
    );
    if let (Some(latency), Some(doubt)) = (totals.latency, totals.clock_doubt_ms) {
        let (median, most) = (latency.median_ms, latency.most_ms);
        text +=
            &format!(", {median:.2} ms after the scan (99 %: {most:.2} ms; clocks known to {doubt:.2} ms)");
    }
    text
}
