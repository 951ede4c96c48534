//! Outbox: what waits to be sent to one client.
//!
//! A client that is slower than a board gets the newest: of each channel only so many messages wait, and older ones give way.

use crate::foxglove::Channel;
use std::{
    collections::VecDeque,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
};

/// Messages of one channel that wait.
const MOST_OF_A_CHANNEL: usize = 8;
/// Texts and answers that wait: whoever asks for more and reads none of it is cut off.
const MOST_TEXTS: usize = 1024;

/// Something to send.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Letter {
    /// A message of a channel, under the client's number for it.
    Message { channel: Channel, subscription: u32, log_time: u64, bytes: Arc<[u8]> },
    /// JSON.
    Text(String),
    /// An answer.
    Binary(Vec<u8>),
    /// To a ping.
    Pong(Vec<u8>),
}

/// What waits.
#[derive(Debug, Default)]
pub(crate) struct Outbox {
    waiting: Mutex<Waiting>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Waiting {
    letters: VecDeque<Letter>,
    texts: usize,
    dropped: u64,
    is_closed: bool,
}

impl Outbox {
    /// Puts something in, unless the client has gone.
    pub(crate) fn put(&self, letter: Letter) {
        let mut waiting = self.lock();
        if waiting.is_closed {
            return;
        }
        match &letter {
            Letter::Message { channel, subscription, .. } => {
                waiting.make_room(*channel, *subscription);
            }
            _ => waiting.texts += 1,
        }
        waiting.is_closed = waiting.texts > MOST_TEXTS;
        waiting.letters.push_back(letter);
        drop(waiting);
        self.changed.notify_one();
    }

    /// All that waits, as soon as there is something; none once it is closed.
    pub(crate) fn take(&self) -> Option<VecDeque<Letter>> {
        let waiting = self.lock();
        let is_idle = |waiting: &mut Waiting| waiting.letters.is_empty() && !waiting.is_closed;
        let mut waiting = self.changed.wait_while(waiting, is_idle).unwrap_or_else(PoisonError::into_inner);
        if waiting.is_closed {
            return None;
        }
        waiting.texts = 0;
        Some(std::mem::take(&mut waiting.letters))
    }

    /// The client has gone, or is to go.
    pub(crate) fn close(&self) {
        self.lock().is_closed = true;
        self.changed.notify_all();
    }

    /// Messages that gave way to newer ones.
    pub(crate) fn dropped(&self) -> u64 {
        self.lock().dropped
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Waiting {
    fn make_room(&mut self, wanted: Channel, of: u32) {
        let is_such = |letter: &Letter| matches!(letter, Letter::Message { channel, subscription, .. } if *channel == wanted && *subscription == of);
        if self.letters.iter().filter(|letter| is_such(letter)).count() >= MOST_OF_A_CHANNEL
            && let Some(oldest) = self.letters.iter().position(is_such)
        {
            self.letters.remove(oldest);
            self.dropped += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_messages::Topic;

    fn message(topic: Topic, log_time: u64) -> Letter {
        let channel = Channel::new(0, topic);
        Letter::Message { channel, subscription: 1, log_time, bytes: Arc::new([]) }
    }

    #[test]
    fn a_client_that_stalls_finds_the_newest_of_each_topic() {
        let outbox = Outbox::default();
        outbox.put(Letter::Text("first".to_owned()));
        outbox.put(message(Topic::Skin, 1));
        (0..1000).for_each(|time| outbox.put(message(Topic::Image, time)));
        let letters = outbox.take().unwrap();
        assert_eq!(letters.len(), 2 + MOST_OF_A_CHANNEL);
        assert_eq!(letters[1], message(Topic::Skin, 1));
        assert_eq!(letters.back(), Some(&message(Topic::Image, 999)));
        assert_eq!(outbox.dropped(), 1000 - MOST_OF_A_CHANNEL as u64);
        outbox.close();
        assert_eq!(outbox.take(), None);
    }

    #[test]
    fn whoever_asks_without_end_and_reads_nothing_is_cut_off() {
        let outbox = Outbox::default();
        (0..=MOST_TEXTS).for_each(|_| outbox.put(Letter::Text("answer".to_owned())));
        assert_eq!(outbox.take(), None);
    }
}
