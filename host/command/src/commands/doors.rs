//! Doors: who may look on at a page, and where.

use anyhow::{Context, ensure};
use dermatome_page::{
    Options, Server, Service,
    gate::{Gate, random_text},
};
use std::net::SocketAddr;

/// Who else may look on.
#[derive(clap::Args, Default)]
pub(super) struct Doors {
    /// Let other computers in: needed for an address that is not this machine's own (127.0.0.1). They need the token in the
    /// address that is printed, and whoever has it can drive the board.
    #[arg(long)]
    allow_remote: bool,
    /// The token that other computers need [default: one that nobody guesses, new each time].
    #[arg(long, value_name = "TEXT", value_parser = token)]
    token: Option<String>,
    /// Let a page of somebody else look on too, as a browser names it: https://app.foxglove.dev. May be repeated. `file://` lets
    /// in every page that is a file of this computer, as the windows of some programs are.
    #[arg(long, value_name = "ORIGIN", value_parser = origin)]
    allow_origin: Vec<String>,
    /// Do not open the browser.
    #[arg(long)]
    no_browser: bool,
}

fn token(text: &str) -> Result<String, &'static str> {
    let is_plain = text.len() >= 8 && text.bytes().all(|byte| byte.is_ascii_alphanumeric());
    if is_plain { Ok(text.to_owned()) } else { Err("allowed: 8 or more letters and digits") }
}

/// Of pages that are files.
const FILES: &str = "file://";

fn origin(text: &str) -> Result<String, &'static str> {
    if text == FILES {
        return Ok(text.to_owned());
    }
    let rest = text.strip_prefix("https://").or_else(|| text.strip_prefix("http://"));
    match rest.filter(|rest| !rest.is_empty() && !rest.contains(['/', '?', '#', '*', ' '])) {
        Some(_) => Ok(text.to_owned()),
        None => Err(
            "allowed: http:// or https:// and a name, with its port if it has one, and nothing behind; or file://",
        ),
    }
}

impl Doors {
    /// For those on this computer.
    pub(super) fn of_this_computer(no_browser: bool) -> Self {
        Self { no_browser, ..Self::default() }
    }

    /// Starts the page's server, says where it is, and opens the browser.
    pub(super) fn open(
        &self,
        listen: SocketAddr,
        services: &'static [Service],
        spaces: Vec<String>,
        is_robot: bool,
        say: impl FnOnce(&str),
    ) -> anyhow::Result<Server> {
        let is_local = listen.ip().is_loopback();
        ensure!(
            is_local || self.allow_remote,
            "`--listen` is {listen}, which other computers may reach: if that is meant, give `--allow-remote`"
        );
        let token = match (&self.token, is_local) {
            (Some(token), _) => Some(token.clone()),
            (None, true) => None,
            (None, false) => {
                Some(random_text().context("the system has no randomness for a token; give `--token`")?)
            }
        };
        let gate = Gate { listen, token, origins: self.allow_origin.clone() };
        let server =
            Server::start(Options { gate, name: "dermatome".to_owned(), services, spaces, is_robot })?;
        say(&server.url());
        if !is_local {
            eprintln!(
                "other computers come in with the token in this address; whoever has it can drive the board"
            );
        }
        if !self.no_browser {
            open_browser(&server);
        }
        Ok(server)
    }
}

/// Shows the page in the browser, if there is one.
pub(super) fn open_browser(server: &Server) {
    if open::that_detached(server.url()).is_err() {
        eprintln!("no browser was found: open the address above");
    }
}
