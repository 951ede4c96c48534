//! What a skin says, as ROS messages: for recordings, and for viewers that look on.
//!
//! A [`dermatome_link::ScanFrame`] -> [`frame::Outlook::messages`] -> [`Packed`] messages, each with its [`Topic`]. They are
//! encoded as CDR, as ROS 2 does, and described by `ros2msg` text ([`schema::definition`]), so that whoever reads
//! ROS 2 recordings reads ours. The definitions of package `dermatome_msgs` lie in `dermatome_msgs/`, a package for ROS 2, beside this crate's code.
#![forbid(unsafe_code)]

pub mod cdr;
pub mod clock;
pub mod dermatome;
pub mod frame;
pub mod scene;
pub mod schema;
pub mod skin;
pub mod standard;
pub mod topic;

pub use topic::{Packed, Topic};
