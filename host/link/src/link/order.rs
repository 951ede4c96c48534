//! Order: events in the order of their numbers, and how many of them are lost.
//!
//! A board keeps its events in two queues and sends what is short and urgent ahead of what is long
//! ([`dermatome_shared::protocol::EventQueue`]). So a number that is passed over may still come: it is lost only
//! once events of both kinds are there that have later ones.

use super::Numbered;
use dermatome_shared::protocol::{Event, Selection};
use std::{collections::VecDeque, time::Duration};

/// More than this never wait for one that was overtaken: it is lost.
const MOST_WAITING: usize = 16;
/// A number at most so far behind may be one that was given up; else the board has started anew.
const MOST_LATE: u32 = 256;

/// Puts events in order. Has all the memory that it will need from the beginning.
#[derive(Debug)]
pub(super) struct Order {
    /// Both kinds are asked for, so that one can overtake the other.
    is_mixed: bool,
    /// Number of the first event, since the board started.
    first: u32,
    /// Number that is due, from the first event on.
    due: Option<u32>,
    /// Numbers that were given up, and may still come: those at most [`MOST_LATE`] behind.
    given_up: Vec<u32>,
    /// Events that came ahead of it, ascending.
    waiting: VecDeque<Numbered>,
    /// Since when the first of them waits.
    since: Option<Duration>,
    lost: u64,
}

impl Default for Order {
    fn default() -> Self {
        Self {
            is_mixed: false,
            first: 0,
            due: None,
            given_up: Vec::with_capacity(MOST_LATE as usize),
            // One more comes before the first is given up.
            waiting: VecDeque::with_capacity(MOST_WAITING + 1),
            since: None,
            lost: 0,
        }
    }
}

impl Order {
    /// Events that did not come, from the first one on.
    pub(super) fn lost(&self) -> u64 {
        self.lost
    }

    /// Takes the event that came `now`; `done` gets all events whose turn it is.
    pub(super) fn take(&mut self, number: u32, event: Event, now: Duration, mut done: impl FnMut(Numbered)) {
        let behind = self.due.map_or(0, |due| due.wrapping_sub(number));
        if self.is_late(number, behind) {
            return done((number, event));
        }
        if behind != 0 && behind <= u32::MAX / 2 {
            self.start_anew(&mut done);
        }
        if self.due.is_none() {
            (self.first, self.due) = (number, Some(number));
        }
        let due = self.due.unwrap_or(number);
        let ahead = |number: u32| number.wrapping_sub(due);
        let place = self.waiting.partition_point(|(other, _)| ahead(*other) < ahead(number));
        self.waiting.insert(place, (number, event));
        self.release(Self::is_lost, done);
        if !self.waiting.is_empty() {
            self.since.get_or_insert(now);
        }
    }

    /// Whether the event of this number, so far behind, was overtaken: by events that made it count as lost, which it
    /// does no more, or by the first one that came.
    fn is_late(&mut self, number: u32, behind: u32) -> bool {
        if let Some(place) = self.given_up.iter().position(|other| *other == number) {
            self.given_up.swap_remove(place);
            self.lost -= 1;
            return true;
        }
        let before_first = self.first.wrapping_sub(number);
        (1..=MOST_LATE).contains(&behind) && (1..=MOST_WAITING as u32).contains(&before_first)
    }

    /// The board has started anew, and counts from the beginning.
    fn start_anew(&mut self, done: impl FnMut(Numbered)) {
        self.give_up(done);
        self.due = None;
        self.given_up.clear();
    }

    /// Another selection begins: what waits has waited long enough; `done` gets it.
    pub(super) fn begin(&mut self, selection: &Selection, done: impl FnMut(Numbered)) {
        self.give_up(done);
        let Selection { images, contacts, measurements, health, scope, .. } = selection;
        self.is_mixed = [images, measurements, scope].iter().any(|every| **every > 0)
            && [contacts, health].iter().any(|every| **every > 0);
    }

    /// How long the first of those that wait has waited.
    pub(super) fn waited(&self, now: Duration) -> Duration {
        self.since.map_or(Duration::ZERO, |since| now.saturating_sub(since))
    }

    /// Nothing is on its way any more: `done` gets what waits.
    pub(super) fn give_up(&mut self, done: impl FnMut(Numbered)) {
        self.release(|_| true, done);
    }

    /// Hands out what waits, up to a number that is not there and may not be `lost`.
    fn release(&mut self, lost: impl Fn(&Self) -> bool, mut done: impl FnMut(Numbered)) {
        while let (Some(due), Some(&(number, _))) = (self.due, self.waiting.front()) {
            if number != due && !lost(self) {
                return;
            }
            self.since = None;
            self.count_lost(due, number);
            self.due = Some(number.wrapping_add(1));
            self.waiting.pop_front().into_iter().for_each(&mut done);
        }
    }

    /// Numbers from `due` up to `next`, which has come, are given up.
    fn count_lost(&mut self, due: u32, next: u32) {
        let lost = next.wrapping_sub(due);
        self.lost += u64::from(lost);
        self.given_up.retain(|number| next.wrapping_sub(*number) <= MOST_LATE);
        self.given_up.extend((1..=lost.min(MOST_LATE)).map(|back| next.wrapping_sub(back)));
    }

    /// Whether the number that is due can come no more.
    fn is_lost(&self) -> bool {
        let has = |long: bool| self.waiting.iter().any(|(_, event)| event.is_long() == long);
        !self.is_mixed || self.waiting.len() > MOST_WAITING || has(true) && has(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::{
        contact::Contacts,
        protocol::{FrameStamp, SlotSamples},
    };
    use proptest::{collection::vec, prelude::*};

    const MIXED: Selection =
        Selection { images: 0, contacts: 1, measurements: 0, health: 0, scope: 1, scope_slot: 0 };

    fn event(is_long: bool) -> Event {
        let at = FrameStamp { sequence: 0, timestamp_us: 0, flags: Default::default() };
        if is_long {
            Event::Scope(SlotSamples::default())
        } else {
            Event::Contacts { at, contacts: Contacts::new() }
        }
    }

    fn ordered(selection: &Selection, events: &[(u32, bool)]) -> (Vec<u32>, u64) {
        let mut order = Order::default();
        let mut numbers = Vec::new();
        order.begin(selection, |_| ());
        for &(number, is_long) in events {
            order.take(number, event(is_long), Duration::ZERO, |(number, _)| numbers.push(number));
        }
        order.give_up(|(number, _)| numbers.push(number));
        (numbers, order.lost())
    }

    #[test]
    fn what_was_overtaken_comes_in_its_turn_and_is_not_lost() {
        let events = [(7, true), (9, false), (11, false), (8, true), (10, true)];
        assert_eq!(ordered(&MIXED, &events), (vec![7, 8, 9, 10, 11], 0));
        let around = [(u32::MAX, false), (1, false), (0, true)];
        assert_eq!(ordered(&MIXED, &around), (vec![u32::MAX, 0, 1], 0));
    }

    #[test]
    fn a_number_is_lost_at_once_where_nothing_can_be_overtaken() {
        let contacts = Selection { scope: 0, ..MIXED };
        let mut order = Order::default();
        order.begin(&contacts, |_| ());
        let mut numbers = Vec::new();
        for number in [3, 6] {
            order.take(number, event(false), Duration::ZERO, |(number, _)| numbers.push(number));
        }
        assert_eq!((numbers, order.lost()), (vec![3, 6], 2));
    }

    #[test]
    fn the_first_of_those_that_wait_has_waited_since_it_came_whatever_comes_behind_it() {
        let mut order = Order::default();
        order.begin(&MIXED, |_| ());
        let at = Duration::from_secs;
        order.take(0, event(false), at(0), |_| ());
        assert_eq!(order.waited(at(9)), Duration::ZERO);
        order.take(2, event(false), at(1), |_| ());
        order.take(3, event(false), at(5), |_| ());
        assert_eq!(order.waited(at(9)), Duration::from_secs(8));
        order.take(1, event(true), at(9), |_| ());
        assert_eq!(order.waited(at(20)), Duration::ZERO);
    }

    #[test]
    fn one_that_was_given_up_and_comes_counts_no_longer_as_lost() {
        let mut events: Vec<_> = (1..40).map(|number| (number, false)).collect();
        events.insert(0, (0, false));
        events.remove(3);
        events.push((3, true));
        let (numbers, lost) = ordered(&MIXED, &events);
        assert_eq!((numbers.len(), numbers.last(), lost), (40, Some(&3), 0));
    }

    #[test]
    fn a_board_that_starts_anew_has_lost_nothing() {
        assert_eq!(ordered(&MIXED, &[(5000, true), (5001, false), (0, false), (1, true)]).1, 0);
    }

    #[test]
    fn a_board_that_starts_anew_after_few_events_does_not_take_back_what_was_lost_before() {
        let mut events = vec![(0, false), (5, false)];
        events.extend((0..4).map(|number| (number, false)));
        let contacts = Selection { scope: 0, ..MIXED };
        assert_eq!(ordered(&contacts, &events), (vec![0, 5, 0, 1, 2, 3], 4));
    }

    #[test]
    fn an_event_that_comes_twice_takes_back_no_loss() {
        let events = [(1, false), (4, false), (4, false), (5, false)];
        let contacts = Selection { scope: 0, ..MIXED };
        assert_eq!(ordered(&contacts, &events).1, 2);
    }

    #[test]
    fn what_the_first_event_overtook_is_no_loss_and_no_new_start() {
        let contacts = Selection { scope: 0, ..MIXED };
        assert_eq!(ordered(&contacts, &[(9, false), (8, true), (10, false)]), (vec![9, 8, 10], 0));
    }

    proptest! {
        /// Two queues, each in order, the urgent one first, as on a board whose line is slow; some events dropped.
        #[test]
        fn two_queues_come_out_as_one(
            kinds in vec((any::<bool>(), 0_u8..10, 0_usize..3), 1..200),
            first in any::<u32>(),
        ) {
            let mut queues = [VecDeque::new(), VecDeque::new()];
            let (mut came, mut sent) = (Vec::new(), Vec::new());
            for (index, (is_long, drop, pops)) in kinds.iter().enumerate() {
                let number = first.wrapping_add(index as u32);
                if *drop > 0 {
                    queues[usize::from(*is_long)].push_back((number, *is_long));
                    sent.push(number);
                }
                // No more than a board has room for wait.
                let pops = if queues[1].len() > 4 { 9 } else { *pops };
                let [urgent, long] = &mut queues;
                came.extend((0..pops).filter_map(|_| urgent.pop_front().or_else(|| long.pop_front())));
            }
            came.extend(queues.into_iter().flatten());
            // The first to come is where counting begins.
            prop_assume!(came.first().is_none_or(|(number, _)| sent.first() == Some(number)));
            let (numbers, lost) = ordered(&MIXED, &came);
            let (from, to) = (sent.first().copied().unwrap_or(0), sent.last().copied().unwrap_or(0));
            let between = u64::from(to.wrapping_sub(from)) + u64::from(!sent.is_empty());
            prop_assert_eq!(numbers.len(), sent.len());
            prop_assert_eq!(lost, between - sent.len() as u64);
            let mut sorted = numbers.clone();
            sorted.sort_by_key(|number| number.wrapping_sub(from));
            prop_assert_eq!(&sorted, &sent);
            if kinds.len() <= MOST_WAITING {
                prop_assert_eq!(numbers, sent);
            }
        }
    }
}
