//! Joint: what it holds, and how it moves.

use super::Check;
use crate::{
    edit::children,
    error::names,
    urdf::{
        meshes::origin,
        robot::{link_in, number, triple},
    },
};
use roxmltree::Node;

/// Kinds of joints.
const KINDS: [&str; 6] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar"];
/// Those that need a limit.
const LIMITED: [&str; 2] = ["revolute", "prismatic"];
/// What a limit may say, in numbers.
const OF_LIMIT: [&str; 4] = ["lower", "upper", "effort", "velocity"];
/// What urdfdom wants of it.
const NEEDED: [&str; 2] = ["effort", "velocity"];
/// Joints whose axis nobody reads.
const UNMOVED: [&str; 2] = ["fixed", "floating"];

impl<'a, 'input> Check<'a, 'input> {
    /// Its links are there, and its numbers are numbers.
    pub(super) fn joint(&mut self, joint: Node<'a, 'input>) {
        let name = joint.attribute("name").unwrap_or_default();
        for which in ["parent", "child"] {
            match link_in(joint, which) {
                None => self.error(joint, format!("joint {name:?} names no {which} link")),
                Some(link) if self.parts.link(link).is_none() => {
                    let allowed = self.parts.listed();
                    let message = format!(
                        "the {which} of joint {name:?} is {link:?}, which is no link; allowed: {allowed}"
                    );
                    self.error(joint, message);
                }
                Some(_) => {}
            }
        }
        if let Err(message) = origin(joint) {
            self.error(joint, format!("joint {name:?}: {message}"));
        }
        let kind = joint.attribute("type").unwrap_or_default();
        if !KINDS.contains(&kind) {
            let allowed = names(KINDS.into_iter());
            self.error(joint, format!("the `type` of joint {name:?} is {kind:?}; allowed: {allowed}"));
        }
        if LIMITED.contains(&kind) && children(joint, "limit").next().is_none() {
            self.error(joint, format!("joint {name:?} is {kind} and has no `limit`"));
        }
        if !UNMOVED.contains(&kind) {
            self.axis(joint, name);
        }
        self.limit(joint, name);
        self.mimic(joint, name);
    }

    fn axis(&mut self, joint: Node<'a, 'input>, name: &str) {
        let Some(axis) = children(joint, "axis").next() else { return };
        match triple(axis, "xyz", 1.0) {
            Err(message) => self.error(axis, format!("joint {name:?}: {message}")),
            Ok([0.0, 0.0, 0.0]) => {
                let message = format!(
                    "the `axis` of joint {name:?} is 0 0 0, which is no direction; allowed: a vector with a length"
                );
                self.warn(axis, message);
            }
            Ok(_) => {}
        }
    }

    /// An end that is not there is 0. Of other kinds of joints urdfdom reads it as well, and nobody uses the ends.
    fn limit(&mut self, joint: Node<'a, 'input>, name: &str) {
        let Some(limit) = children(joint, "limit").next() else { return };
        for part in OF_LIMIT {
            if let Some(text) = limit.attribute(part).filter(|_| number(limit, part).is_none()) {
                let message = format!("the limit of joint {name:?} has {part} = {text:?}; allowed: a number");
                return self.error(limit, message);
            }
        }
        let missing: Vec<_> = NEEDED
            .into_iter()
            .filter(|part| !limit.has_attribute(*part))
            .map(|part| format!("`{part}`"))
            .collect();
        if !missing.is_empty() {
            let missing = missing.join(" and ");
            let message = format!(
                "the limit of joint {name:?} has no {missing}: urdfdom, and with it ROS, refuses the robot"
            );
            self.warn(limit, message);
        }
        let is_limited = joint.attribute("type").is_some_and(|kind| LIMITED.contains(&kind));
        let [lower, upper] = ["lower", "upper"].map(|end| number(limit, end).unwrap_or(0.0));
        if is_limited && lower > upper {
            let message = format!(
                "joint {name:?} has lower = {lower} above upper = {upper}, so it can be nowhere; allowed: lower up to upper"
            );
            self.warn(limit, message);
        }
    }

    fn mimic(&mut self, joint: Node<'a, 'input>, name: &str) {
        let Some(mimic) = children(joint, "mimic").next() else { return };
        match mimic.attribute("joint") {
            None => self.error(mimic, format!("the `mimic` of joint {name:?} names no joint")),
            Some(other) if !self.parts.has_joint(other) => {
                let message = format!("joint {name:?} mimics {other:?}, which is no joint: it will not move");
                self.warn(mimic, message);
            }
            Some(_) => {}
        }
    }
}
