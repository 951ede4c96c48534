//! Hand: what presses a skin while it is scanned, as somebody else tells it; a script knows it beforehand.

use super::path_file::Row;
use dermatome_geometry::outline::Outline;
use dermatome_model::indenter::{Load, Press, PressError};
use nalgebra::Point2;
use serde::Deserialize;
use std::sync::{Arc, Mutex, PoisonError};

/// Most indenters at a time.
const MOST: usize = 64;

/// Indenters that touch a skin now: one who tells, and one who simulates the skin, each hold one.
#[derive(Clone, Debug, Default)]
pub struct Hand {
    presses: Arc<Mutex<Vec<Press>>>,
}

/// Why a line tells no presses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HandError {
    /// It is no JSON of this form.
    #[error(
        "{0}; allowed: {{\"presses\": [{{\"x_m\": 0.01, \"y_m\": 0, \"radius_m\": 0.008, \"force_n\": 2}}]}} and the other columns of a path file"
    )]
    Form(String),
    /// A press makes no sense.
    #[error(transparent)]
    Press(#[from] PressError),
    /// There are too many.
    #[error("`presses` are {found}; allowed: at most {MOST}")]
    Many {
        /// How many.
        found: usize,
    },
    /// A pressure or a force on a sheet of no material.
    #[error(
        "`pressure_kpa` and `force_n` say nothing without a material; allowed: `depth`, or to give a `material`"
    )]
    NoMaterial,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    presses: Vec<Row>,
}

impl Hand {
    /// A hand with these indenters, and no others.
    pub fn press(&self, presses: Vec<Press>) {
        *self.presses.lock().unwrap_or_else(PoisonError::into_inner) = presses;
    }

    /// Those that touch now.
    #[must_use]
    pub fn presses(&self) -> Vec<Press> {
        self.presses.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Presses as a line of JSON says from now on, with the columns of a path file as keys; those beside the skin press
    /// nothing.
    pub fn follow(&self, line: &str, outline: &Outline, has_material: bool) -> Result<(), HandError> {
        let Line { presses } =
            serde_json::from_str(line).map_err(|error| HandError::Form(error.to_string()))?;
        if presses.len() > MOST {
            return Err(HandError::Many { found: presses.len() });
        }
        let presses: Result<Vec<_>, _> =
            presses.iter().map(|row| row.press().map_err(HandError::Form)).collect();
        let mut presses = presses?;
        presses
            .retain(|press| outline.depth(Point2::from(press.position)) >= 0.0 && press.load.value() != 0.0);
        presses.iter().try_for_each(|press| press.check(outline))?;
        if !has_material && presses.iter().any(|press| !matches!(press.load, Load::Change(_))) {
            return Err(HandError::NoMaterial);
        }
        self.press(presses);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn follow(line: &str, has_material: bool) -> Result<Vec<Press>, String> {
        let hand = Hand::default();
        hand.press(vec![Press::finger([0.0; 2], 0.01, 1.0)]);
        let followed = hand.follow(line, &Outline::disc(0.1), has_material);
        followed.map(|()| hand.presses()).map_err(|error| error.to_string())
    }

    #[test]
    fn each_line_says_all_that_touches_from_now_on() {
        let finger = r#"{"presses": [{"x_m": 0.01, "y_m": -2e-2, "radius_m": 0.01, "depth": 1}]}"#;
        assert_eq!(follow(finger, false), Ok(vec![Press::finger([0.01, -0.02], 0.01, 1.0)]));
        assert_eq!(follow(r#"{"presses": []}"#, false), Ok(vec![]));
        let lifted = r#"{"presses": [{"x_m": 0.2, "y_m": 0, "radius_m": 0.01, "force_n": 1},
                                     {"x_m": 0, "y_m": 0, "radius_m": 0.01, "force_n": 0}]}"#;
        assert_eq!(follow(lifted, false), Ok(vec![]), "one beside the skin, one of no load");
        let square =
            r#"{"presses": [{"x_m": 0, "y_m": 0, "shape": "square", "radius_m": 0.01, "force_n": 3}]}"#;
        assert_eq!(follow(square, true).unwrap()[0].load, Load::Force(3.0));
    }

    #[test]
    fn lines_that_make_no_sense_say_why() {
        let press = |inner: &str| format!(r#"{{"presses": [{{"x_m": 0, "y_m": 0, {inner}}}]}}"#);
        let many = format!(
            r#"{{"presses": [{}]}}"#,
            vec![r#"{"x_m":0,"y_m":0,"radius_m":1,"depth":1}"#; 65].join(",")
        );
        for (line, expected) in [
            ("", "allowed: {\"presses\""),
            ("[]", "allowed: {\"presses\""),
            ("{}", "missing field `presses`"),
            (&press(r#""radius_m": 0.01, "deep": 1"#), "unknown field `deep`"),
            (&press(r#""radius_m": 0.01"#), "exactly one"),
            (&press(r#""depth": 1"#), "column `radius_m`: empty"),
            (&press(r#""radius_m": -1, "depth": 1"#), "radius"),
            (&press(r#""radius_m": 0.01, "depth": -3"#), "depth"),
            (&press(r#""radius_m": 1e999, "depth": 1"#), "number out of range"),
            (&press(r#""radius_m": 0.01, "force_n": 1"#), "without a material"),
            (&many, "are 65; allowed: at most 64"),
        ] {
            let error = follow(line, false).unwrap_err();
            assert!(error.contains(expected), "{line}: {error}");
        }
    }
}
