//! Parts: a robot's links and joints by name, and lines of its text, each found at once however many there are.

use crate::{edit::children, error::names, urdf::robot::link_in};
use roxmltree::Node;
use std::{
    cell::OnceCell,
    collections::{BTreeMap, BTreeSet},
};

pub(super) struct Parts<'a, 'input> {
    links: BTreeMap<&'a str, Node<'a, 'input>>,
    joints: BTreeSet<&'a str>,
    /// Joints by the link that they hold.
    onto: BTreeMap<&'a str, Vec<Node<'a, 'input>>>,
    /// In the order of the file.
    link_names: Vec<&'a str>,
    listed: OnceCell<String>,
    /// Where lines end.
    ends: Vec<usize>,
}

impl<'a, 'input> Parts<'a, 'input> {
    pub(super) fn of(robot: Node<'a, 'input>, text: &str) -> Self {
        let named =
            |kind| children(robot, kind).filter_map(|node| node.attribute("name").map(|name| (name, node)));
        let mut links = BTreeMap::new();
        // Of several the first.
        named("link").for_each(|(name, link)| _ = links.entry(name).or_insert(link));
        let mut onto: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for joint in children(robot, "joint") {
            if let Some(child) = link_in(joint, "child") {
                onto.entry(child).or_default().push(joint);
            }
        }
        Self {
            links,
            joints: named("joint").map(|(name, _)| name).collect(),
            onto,
            link_names: named("link").map(|(name, _)| name).collect(),
            listed: OnceCell::new(),
            ends: text.match_indices('\n').map(|(at, _)| at).collect(),
        }
    }

    pub(super) fn link(&self, name: &str) -> Option<Node<'a, 'input>> {
        self.links.get(name).copied()
    }

    pub(super) fn link_names(&self) -> &[&'a str] {
        &self.link_names
    }

    /// Its links' names as an error lists them.
    pub(super) fn listed(&self) -> &str {
        self.listed.get_or_init(|| names(self.link_names.iter().copied()))
    }

    pub(super) fn has_joint(&self, name: &str) -> bool {
        self.joints.contains(name)
    }

    /// Joints that hold a link.
    pub(super) fn joints_onto(&self, link: &str) -> &[Node<'a, 'input>] {
        self.onto.get(link).map_or(&[], Vec::as_slice)
    }

    /// The line of a node, from 1.
    pub(super) fn line(&self, node: Node<'_, '_>) -> u32 {
        let before = self.ends.partition_point(|end| *end < node.range().start);
        u32::try_from(before + 1).unwrap_or(u32::MAX)
    }
}
