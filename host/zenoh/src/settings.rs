//! Settings: where on the network, by a configuration file of Zenoh's own and by endpoints.

use crate::key::Space;
use std::path::PathBuf;
use zenoh::{Config, Session, Wait, config::EndPoint};

/// What Zenoh does otherwise than usual, unless its configuration file has another value than the usual one: a computer that
/// is cut off is known to be gone, and found again, within a second each. Times in ms.
const OTHERWISE: [(&str, &str); 6] = [
    // Nothing heard for so long: the other one is gone. A sign of life is sent four times as often.
    ("transport/link/tx/lease", "1000"),
    // To who does not answer is connected anew; TCP itself would wait longer each time.
    ("transport/unicast/open_timeout", "500"),
    ("connect/retry", "{period_init_ms: 100, period_max_ms: 500, period_increase_factor: 2}"),
    // A computer that is busy sends late: what is urgent waits in so many batches of 64 kB, the most there may be.
    ("transport/link/tx/queue/size/interactive_high", "16"),
    // A message takes less; what is longer is not ours.
    ("transport/link/rx/max_message_size", "4194304"),
    ("scouting/delay", "100"),
];

/// Where a program is on the network.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Configuration of Zenoh, JSON5 or YAML.
    pub file: Option<PathBuf>,
    /// Endpoints to connect to, besides those of the file: `tcp/192.168.0.10:7447`.
    pub connect: Vec<String>,
    /// Endpoints to listen at, besides those of the file.
    pub listen: Vec<String>,
}

/// Why a program is not on the network.
#[derive(Debug, thiserror::Error)]
pub enum ZenohError {
    /// The configuration file.
    #[error("Zenoh's configuration `{}`: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// An endpoint.
    #[error("the endpoint {endpoint:?} is none ({reason}); allowed: such as \"tcp/192.168.0.10:7447\"")]
    Endpoint {
        /// As it was given.
        endpoint: String,
        /// What is wrong with it.
        reason: String,
    },
    /// More robots than one, and none was named.
    #[error("there are the robots `{0}`; name one of them")]
    Robots(String),
    /// No such skin.
    #[error("no computer serves a skin `{patch}` of the robot `{robot}`; there are: {}", if known.is_empty() { "none" } else { known.as_str() })]
    Patch {
        /// The robot's name.
        robot: String,
        /// The skin's.
        patch: String,
        /// Those that are there.
        known: String,
    },
    /// An order would be carried out more than once.
    #[error(
        "{count} programs say that they serve `{space}`, and each would do it; end all but one (`dermatome body` names their computers)"
    )]
    Claimed {
        /// The skin.
        space: Box<Space>,
        /// How many say so.
        count: usize,
    },
    /// What Zenoh does not do.
    #[error("Zenoh: {0}")]
    Zenoh(String),
}

impl From<zenoh::Error> for ZenohError {
    fn from(error: zenoh::Error) -> Self {
        Self::Zenoh(error.to_string())
    }
}

impl Settings {
    pub(crate) fn open(&self) -> Result<Session, ZenohError> {
        Ok(zenoh::open(self.config()?).wait()?)
    }

    /// As Zenoh takes them.
    pub fn config(&self) -> Result<Config, ZenohError> {
        let usual = Config::default();
        let mut config = match &self.file {
            None => Config::default(),
            Some(path) => Config::from_file(path)
                .map_err(|error| ZenohError::File { path: path.clone(), reason: error.to_string() })?,
        };
        for (key, value) in OTHERWISE {
            if config.get_json(key)? == usual.get_json(key)? {
                config.insert_json5(key, value)?;
            }
        }
        add(&mut config, "connect/endpoints", &self.connect)?;
        add(&mut config, "listen/endpoints", &self.listen)?;
        let is_told_where = !self.connect.is_empty() || !self.listen.is_empty();
        if is_told_where && self.file.is_none() {
            config.insert_json5("scouting/multicast/enabled", "false")?;
        }
        Ok(config)
    }
}

/// Endpoints besides those that the file has as a list.
fn add(config: &mut Config, key: &str, endpoints: &[String]) -> Result<(), ZenohError> {
    if endpoints.is_empty() {
        return Ok(());
    }
    for endpoint in endpoints {
        endpoint.parse::<EndPoint>().map_err(|error| ZenohError::Endpoint {
            endpoint: endpoint.clone(),
            reason: error.to_string(),
        })?;
    }
    let held: Vec<String> = serde_json::from_str(&config.get_json(key)?).unwrap_or_default();
    let all: Vec<&String> = held.iter().chain(endpoints).collect();
    let text = serde_json::to_string(&all).map_err(|error| ZenohError::Zenoh(error.to_string()))?;
    Ok(config.insert_json5(key, &text)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(connect: &[&str]) -> Settings {
        Settings { connect: connect.iter().map(ToString::to_string).collect(), ..Settings::default() }
    }

    fn of_file(text: &str, connect: &[&str]) -> Result<Config, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("zenoh.json5");
        std::fs::write(&path, text).unwrap();
        let settings = Settings { file: Some(path), ..settings(connect) };
        settings.config().map_err(|error| error.to_string())
    }

    #[test]
    fn who_is_cut_off_is_soon_known_to_be_unless_the_file_says_otherwise() {
        let config = Settings::default().config().unwrap();
        assert_eq!(config.get_json("transport/link/tx/lease").unwrap(), "1000");
        assert!(config.get_json("connect/retry").unwrap().contains("\"period_max_ms\":500"));
        let config = of_file("{transport: {link: {tx: {lease: 7000}}}}", &[]).unwrap();
        assert_eq!(config.get_json("transport/link/tx/lease").unwrap(), "7000");
        assert!(config.get_json("connect/retry").unwrap().contains("\"period_max_ms\":500"));
    }

    #[test]
    fn endpoints_come_to_those_of_the_file_and_without_one_nobody_is_looked_for() {
        let multicast = |config: &Config| config.get_json("scouting/multicast/enabled").unwrap();
        assert_ne!(multicast(&Settings::default().config().unwrap()), "false");
        let config = settings(&["tcp/10.0.0.1:7447"]).config().unwrap();
        assert_eq!(config.get_json("connect/endpoints").unwrap(), "[\"tcp/10.0.0.1:7447\"]");
        assert_eq!(multicast(&config), "false");
        let config = of_file("{connect: {endpoints: [\"tcp/10.0.0.2:1\"]}}", &["tcp/10.0.0.1:7447"]).unwrap();
        let both = "[\"tcp/10.0.0.2:1\",\"tcp/10.0.0.1:7447\"]";
        assert_eq!(config.get_json("connect/endpoints").unwrap(), both);
        assert_ne!(multicast(&config), "false");
    }

    #[test]
    fn what_is_wrong_is_said_in_words() {
        let error = settings(&["10.0.0.1"]).config().unwrap_err().to_string();
        assert!(error.starts_with("the endpoint \"10.0.0.1\" is none ("), "{error}");
        let error = of_file("{mode: 7}", &[]).unwrap_err();
        assert!(error.contains("zenoh.json5"), "{error}");
        let none = Settings { file: Some("none.json5".into()), ..Settings::default() };
        let error = none.config().unwrap_err().to_string();
        assert!(error.starts_with("Zenoh's configuration `none.json5`"), "{error}");
    }
}
