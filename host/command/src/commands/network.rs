//! Network: where on it a program is, by Zenoh.

use std::path::PathBuf;

/// Where on the network.
#[derive(clap::Args)]
pub(super) struct Network {
    /// Zenoh's own configuration, JSON5: TLS, access control, mode and all else (docs/zenoh.md).
    #[arg(long, value_name = "FILE")]
    pub(super) zenoh_config: Option<PathBuf>,
    /// Connect to another computer: tcp/192.168.0.10:7447. Without endpoints and file, others are looked for by
    /// multicast.
    #[arg(long, value_name = "ENDPOINT", value_parser = endpoint)]
    pub(super) zenoh_connect: Vec<String>,
    /// Be found by other computers here: tcp/0.0.0.0:7447.
    #[arg(long, value_name = "ENDPOINT", value_parser = endpoint)]
    pub(super) zenoh_listen: Vec<String>,
}

/// Where something is, as Zenoh writes it; which protocols there are is Zenoh's to say.
fn endpoint(text: &str) -> Result<String, String> {
    match text.split_once('/') {
        Some((protocol, address)) if !protocol.is_empty() && !address.is_empty() => Ok(text.to_owned()),
        _ => Err("allowed: PROTOCOL/ADDRESS, such as tcp/192.168.0.10:7447".to_owned()),
    }
}

impl Network {
    pub(super) fn is_given(&self) -> bool {
        self.zenoh_config.is_some() || !self.zenoh_connect.is_empty() || !self.zenoh_listen.is_empty()
    }
}

#[cfg(feature = "zenoh")]
impl From<&Network> for dermatome_zenoh::Settings {
    fn from(network: &Network) -> Self {
        Self {
            file: network.zenoh_config.clone(),
            connect: network.zenoh_connect.clone(),
            listen: network.zenoh_listen.clone(),
        }
    }
}
