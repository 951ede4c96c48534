//! Settings: where on the network, and how services are spoken, by the variables that ROS 2 goes by.

use ros2_client::ServiceMapping;

/// Most that a domain's ports allow.
pub const LARGEST_DOMAIN: u16 = 232;

/// Where a node is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Nodes of one domain see each other.
    pub domain: u16,
    /// Whether only programs on this computer see it.
    pub is_local: bool,
    /// How requests and replies tell to which of them they belong: otherwise in each kind of DDS.
    pub mapping: ServiceMapping,
}

/// A variable that holds what it may not.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the environment's `{variable}` is {value:?}; allowed: {allowed}")]
pub struct SettingsError {
    /// Which.
    pub variable: &'static str,
    /// What it holds.
    pub value: String,
    /// What it may.
    pub allowed: &'static str,
}

impl Settings {
    /// By the environment, in this domain if one is given.
    pub fn from_environment(domain: Option<u16>) -> Result<Self, SettingsError> {
        Self::read(domain, |name| std::env::var(name).ok())
    }

    fn read(domain: Option<u16>, variable: impl Fn(&str) -> Option<String>) -> Result<Self, SettingsError> {
        let held = |name| variable(name).filter(|value| !value.is_empty());
        let refuse = |variable, value, allowed| Err(SettingsError { variable, value, allowed });
        let domain = match (domain, held("ROS_DOMAIN_ID")) {
            (Some(domain), _) => domain,
            (None, None) => 0,
            (None, Some(text)) => match text.parse() {
                Ok(domain) if domain <= LARGEST_DOMAIN => domain,
                _ => return refuse("ROS_DOMAIN_ID", text, "0 to 232"),
            },
        };
        let is_local = match held("ROS_AUTOMATIC_DISCOVERY_RANGE").as_deref() {
            Some("LOCALHOST") => true,
            None | Some("SUBNET" | "SYSTEM_DEFAULT") => held("ROS_LOCALHOST_ONLY").as_deref() == Some("1"),
            Some(other) => {
                let allowed = "LOCALHOST, SUBNET and SYSTEM_DEFAULT";
                return refuse("ROS_AUTOMATIC_DISCOVERY_RANGE", other.to_owned(), allowed);
            }
        };
        let mapping = match held("RMW_IMPLEMENTATION").as_deref() {
            None | Some("rmw_fastrtps_cpp" | "rmw_fastrtps_dynamic_cpp" | "rmw_connextdds") => {
                ServiceMapping::Enhanced
            }
            Some("rmw_cyclonedds_cpp") => ServiceMapping::Cyclone,
            Some(other) => {
                let allowed =
                    "rmw_fastrtps_cpp, rmw_fastrtps_dynamic_cpp, rmw_connextdds and rmw_cyclonedds_cpp";
                return refuse("RMW_IMPLEMENTATION", other.to_owned(), allowed);
            }
        };
        Ok(Self { domain, is_local, mapping })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(domain: Option<u16>, held: &[(&str, &str)]) -> Result<Settings, String> {
        let variable = |name: &str| {
            held.iter().find(|(variable, _)| *variable == name).map(|(_, value)| (*value).to_owned())
        };
        Settings::read(domain, variable).map_err(|error| error.to_string())
    }

    #[test]
    fn the_environment_of_ros_says_where() {
        let usual = Settings { domain: 0, is_local: false, mapping: ServiceMapping::Enhanced };
        assert_eq!(read(None, &[]), Ok(usual));
        assert_eq!(read(None, &[("ROS_DOMAIN_ID", "")]), Ok(usual));
        assert_eq!(read(None, &[("ROS_DOMAIN_ID", "42")]), Ok(Settings { domain: 42, ..usual }));
        assert_eq!(read(Some(7), &[("ROS_DOMAIN_ID", "42")]), Ok(Settings { domain: 7, ..usual }));
        assert_eq!(read(None, &[("ROS_LOCALHOST_ONLY", "1")]), Ok(Settings { is_local: true, ..usual }));
        let local =
            [("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"), ("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")];
        let cyclone = Settings { is_local: true, mapping: ServiceMapping::Cyclone, ..usual };
        assert_eq!(read(None, &local), Ok(cyclone));
    }

    #[test]
    fn what_it_may_not_hold_is_refused_in_words() {
        let cases = [
            (("ROS_DOMAIN_ID", "233"), "`ROS_DOMAIN_ID` is \"233\"; allowed: 0 to 232"),
            (
                ("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"),
                "`ROS_AUTOMATIC_DISCOVERY_RANGE` is \"OFF\"; allowed: LOCALHOST",
            ),
            (
                ("RMW_IMPLEMENTATION", "rmw_zenoh_cpp"),
                "`RMW_IMPLEMENTATION` is \"rmw_zenoh_cpp\"; allowed: rmw_fastrtps",
            ),
        ];
        for (held, words) in cases {
            let error = read(None, &[held]).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }
}
