//! Counters: how many errors a node has met, and what it may do after that (ISO 11898-1, fault confinement).

/// Error counters of one node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Counters {
    /// TEC.
    pub(super) transmit: u32,
    /// REC.
    pub(super) receive: u32,
}

impl Counters {
    /// From here on a node is error passive.
    const PASSIVE: u32 = 128;

    /// It has sent a frame.
    pub(super) fn sent(&mut self) {
        self.transmit = self.transmit.saturating_sub(1);
    }

    /// It has received one.
    pub(super) fn received(&mut self) {
        self.receive = self.receive.min(Self::PASSIVE).saturating_sub(1);
    }

    /// What it sent met an error. Where only the acknowledgement is missing, a passive node does not count: it may be alone.
    pub(super) fn failed(&mut self, only_unacknowledged: bool) {
        if !(only_unacknowledged && self.is_passive()) {
            self.transmit += 8;
        }
    }

    /// What another one sent met an error, which this one was the first to notice, or not.
    pub(super) fn disturbed(&mut self, first: bool) {
        self.receive = (self.receive + if first { 8 } else { 1 }).min(Self::PASSIVE);
    }

    pub(super) fn is_warned(self) -> bool {
        self.transmit.max(self.receive) >= 96
    }

    pub(super) fn is_passive(self) -> bool {
        self.transmit.max(self.receive) >= Self::PASSIVE
    }

    /// It must leave the bus.
    pub(super) fn is_off(self) -> bool {
        self.transmit > 255
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_that_nobody_acknowledges_becomes_passive_and_stays_on_the_bus() {
        let mut alone = Counters::default();
        (0..1000).for_each(|_| alone.failed(true));
        assert_eq!((alone.transmit, alone.is_passive(), alone.is_off()), (128, true, false));
        alone.sent();
        assert!(!alone.is_passive() && alone.is_warned());
    }

    #[test]
    fn other_errors_lead_off_the_bus() {
        let mut node = Counters::default();
        (0..31).for_each(|_| node.failed(false));
        assert!(!node.is_off());
        node.failed(false);
        assert!(node.is_off());
    }

    #[test]
    fn a_listener_recovers_with_each_frame_that_it_understands() {
        let mut node = Counters::default();
        (0..200).for_each(|_| node.disturbed(true));
        assert_eq!((node.receive, node.is_off()), (128, false));
        node.received();
        assert_eq!((node.receive, node.is_passive()), (127, false));
        (0..200).for_each(|_| node.received());
        node.disturbed(false);
        assert_eq!(node, Counters { transmit: 0, receive: 1 });
    }
}
