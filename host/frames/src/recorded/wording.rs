//! Advice on how to read a file, whatever a program calls the settings for it.

use super::order::{Arrangement, SenseOrder};
use std::fmt;

/// What a program calls the settings with which a file is read.
pub trait Wording {
    /// The settings that choose this arrangement; empty for the usual one.
    fn arrangement(&self, arrangement: &Arrangement) -> String;

    /// The advice to subtract this from every value.
    fn offset(&self, value: f64) -> String;
}

/// This library's own words.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plain;

impl Wording for Plain {
    fn arrangement(&self, arrangement: &Arrangement) -> String {
        let parts = [
            (arrangement.sense == SenseOrder::Relative).then(|| "relative order".to_owned()),
            (arrangement.rotation > 0).then(|| format!("rotation by {}", arrangement.rotation)),
            arrangement.mirrored.then(|| "mirrored electrodes".to_owned()),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }

    fn offset(&self, value: f64) -> String {
        format!("subtract {value:.4}")
    }
}

/// A change from one arrangement to another that fits better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rearrangement {
    /// The arrangement in use.
    pub used: Arrangement,
    /// The better one.
    pub best: Arrangement,
    /// Whether other rotations fit as well.
    pub rotation_ambiguous: bool,
}

impl Rearrangement {
    /// What to set and what to leave out.
    #[must_use]
    pub fn told(&self, wording: &impl Wording) -> String {
        let [best, dropped] =
            [self.best, self.dropped()].map(|arrangement| wording.arrangement(&arrangement));
        match (best.as_str(), dropped.as_str()) {
            ("", dropped) => format!("leave out {dropped}"),
            (best, "") => format!("use {best}"),
            (best, dropped) => format!("use {best}, without {dropped}"),
        }
    }

    /// What must no longer be set.
    fn dropped(&self) -> Arrangement {
        let Self { used, best, .. } = self;
        Arrangement {
            sense: if used.sense == best.sense { SenseOrder::default() } else { used.sense },
            rotation: if best.rotation == 0 { used.rotation } else { 0 },
            mirrored: used.mirrored && !best.mirrored,
        }
    }
}

/// What to change.
#[derive(Clone, Debug, PartialEq)]
pub enum Advice {
    /// Something that no setting does.
    Plain(String),
    /// Read the file in another order.
    Rearrange(Rearrangement),
    /// Subtract this from every value.
    Subtract(f64),
}

impl Advice {
    /// The advice with a program's names for its settings.
    #[must_use]
    pub fn told(&self, wording: &impl Wording) -> String {
        match self {
            Self::Plain(words) => words.clone(),
            Self::Rearrange(change) if change.rotation_ambiguous => {
                change.told(wording) + "; the rotation cannot be told from these frames, others fit as well"
            }
            Self::Rearrange(change) => change.told(wording),
            Self::Subtract(value) => {
                wording.offset(*value) + ", or normalised differences come out too small"
            }
        }
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told(&Plain))
    }
}

impl From<&str> for Advice {
    fn from(words: &str) -> Self {
        Self::Plain(words.to_owned())
    }
}

impl From<String> for Advice {
    fn from(words: String) -> Self {
        Self::Plain(words)
    }
}
