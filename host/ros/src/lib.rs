//! A robot's body of skins as a ROS 2 node: contacts, images and what presses on each link as topics, tare and drive as
//! services, over DDS. It needs no ROS installation to be built, nor to run.
//!
//! [`Settings`] say where on the network, as the variables of ROS 2 do; [`Robot::start`] makes the node; [`Robot::tell`]
//! publishes what [`dermatome_body::Body`] has taken; [`Robot::attend`] gives what services ask for. Topics, types and
//! quality of service are in docs/ros.md.
#![forbid(unsafe_code)]

mod message;
pub mod names;
mod node;
mod robot;
mod service;
pub mod settings;
mod skin;

pub use node::RosError;
pub use robot::Robot;
pub use settings::Settings;
