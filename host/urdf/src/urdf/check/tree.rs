//! Tree: links and joints make one.

use super::{Check, Level};
use crate::{edit::children, error::names, urdf::robot::link_in};
use roxmltree::Node;
use std::collections::{BTreeMap, BTreeSet};

impl<'a, 'input> Check<'a, 'input> {
    /// Links and joints make one tree; its root.
    pub(super) fn tree(&mut self, robot: Node<'a, 'input>) -> Option<String> {
        let parents = self.parents(robot);
        let links = self.parts.link_names();
        let roots: Vec<&str> = links.iter().copied().filter(|link| !parents.contains_key(link)).collect();
        let circle = in_circle(links, &parents);
        match roots[..] {
            [] if links.is_empty() => self.find(Level::Error, None, "the robot has no link".to_owned()),
            [] => {}
            [root] if circle.is_empty() => return Some(root.to_owned()),
            [_] => {}
            _ => {
                let message =
                    format!("no joint holds {}; allowed: one such link, the root", names(roots.into_iter()));
                self.find(Level::Error, None, message);
            }
        }
        if !circle.is_empty() {
            let message = format!("joints go in a circle at {}", names(circle.into_iter()));
            self.find(Level::Error, None, message);
        }
        None
    }

    /// The parent of each link that is held.
    fn parents(&mut self, robot: Node<'a, 'input>) -> BTreeMap<&'a str, &'a str> {
        let mut parents = BTreeMap::new();
        for joint in children(robot, "joint") {
            let (Some(parent), Some(child)) = (link_in(joint, "parent"), link_in(joint, "child")) else {
                continue;
            };
            if let Some(other) = parents.insert(child, parent) {
                self.error(
                    joint,
                    format!("link {child:?} has two parents, {other:?} and {parent:?}; allowed: one"),
                );
            }
        }
        parents
    }
}

/// Links from which no way up ends. Each is walked once: a way ends where one that was walked before goes on.
fn in_circle<'a>(links: &[&'a str], parents: &BTreeMap<&'a str, &'a str>) -> BTreeSet<&'a str> {
    let mut ends: BTreeMap<&str, bool> = BTreeMap::new();
    for link in links {
        let mut way = vec![*link];
        let mut on_way = BTreeSet::from([*link]);
        let does_end = loop {
            let at = way[way.len() - 1];
            if let Some(end) = ends.get(at) {
                break *end;
            }
            match parents.get(at) {
                None => break true,
                Some(parent) if !on_way.insert(*parent) => break false,
                Some(parent) => way.push(*parent),
            }
        };
        ends.extend(way.into_iter().map(|link| (link, does_end)));
    }
    links.iter().copied().filter(|link| ends.get(link) == Some(&false)).collect()
}
