//! Words of others, as text and nothing else: what would steer a terminal is escaped. And what reflexes say, in words.

use dermatome_shared::{patch::reflexes::ReflexRule, pipeline::reflex::Reflexes};

/// What `escape_debug` would escape though no terminal minds it.
const HARMLESS: &[char] = &['"', '\'', '\\'];
/// The same, with what lines and tables of them are made of.
const OF_LINES: &[char] = &['"', '\'', '\\', '\n', '\t'];

/// A name or a line of text, its control characters and those that are not seen as `\u{1b}` and the like.
#[must_use]
pub fn escaped(text: &str) -> String {
    escape(text, HARMLESS).collect()
}

/// The same for several lines: line ends and tabs stay.
#[must_use]
pub fn escaped_lines(text: &str) -> String {
    escape(text, OF_LINES).collect()
}

/// What a patch's reflexes say that people should know: each rule that is tripped, with its pin, and whether the board cannot tell.
#[must_use]
pub fn reflexes(rules: &[ReflexRule], now: &Reflexes) -> Vec<String> {
    let tripped = rules.iter().enumerate().filter(|(rule, _)| now.is_tripped(*rule));
    let mut words: Vec<String> = tripped
        .map(|(_, rule)| format!("reflex `{}` is tripped: pin {} is low", escaped(&rule.name), rule.pin))
        .collect();
    if now.is_blind {
        words.push("reflexes are blind: the board cannot tell what presses".to_owned());
    }
    words
}

/// The same in no more room than the text may take; what has no room any more is left away.
pub(crate) fn escaped_within<const N: usize>(text: &heapless::String<N>) -> heapless::String<N> {
    let mut within = heapless::String::new();
    // Fails where the room ends.
    let _ = escape(text, HARMLESS).try_for_each(|c| within.push(c));
    within
}

fn escape<'a>(text: &'a str, kept: &'static [char]) -> impl Iterator<Item = char> + 'a {
    text.split_inclusive(kept).flat_map(move |piece| {
        let end = piece.chars().next_back().filter(|last| kept.contains(last));
        let words = end.map_or(piece, |last| &piece[..piece.len() - last.len_utf8()]);
        words.escape_debug().chain(end)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::patch::reflexes::Limit;

    #[test]
    fn reflexes_that_are_tripped_are_named_with_their_pins() {
        let rule = |name: &str, pin| ReflexRule {
            name: name.try_into().unwrap(),
            pin,
            limit: Limit::Strength(0.5),
            release: 0.8,
            frames: 2,
            hold: 0.1,
            trips_blind: true,
            rows: 1,
        };
        let rules = [rule("hug", 1), rule("bumper", 3)];
        let now =
            |tripped, is_blind| Reflexes { tripped, is_blind, values: [0.0, 0.7].into_iter().collect() };
        assert!(reflexes(&rules, &now(0, false)).is_empty());
        assert_eq!(reflexes(&rules, &now(2, false)), ["reflex `bumper` is tripped: pin 3 is low"]);
        let blind = reflexes(&rules, &now(3, true));
        assert_eq!(blind[0], "reflex `hug` is tripped: pin 1 is low");
        assert_eq!(blind[2], "reflexes are blind: the board cannot tell what presses");
    }

    #[test]
    fn what_steers_a_terminal_is_escaped_and_what_people_read_stays() {
        assert_eq!(escaped("\x1b]0;title\x07\r\n"), "\\u{1b}]0;title\\u{7}\\r\\n");
        assert_eq!(escaped("\u{9b}2J\u{202e}\u{200b}"), "\\u{9b}2J\\u{202e}\\u{200b}");
        for text in ["it's \"1\" \\ `a`", "Größe µm², 皮膚, हिन्दी", ""] {
            assert_eq!(escaped(text), text);
        }
        assert_eq!(escaped_lines("a\tb\nc\x1b\n"), "a\tb\nc\\u{1b}\n");
    }

    #[test]
    fn a_name_stays_within_its_room() {
        let name = heapless::String::<8>::try_from("abcdef\x1b").unwrap();
        assert_eq!(escaped_within(&name), "abcdef\\u");
    }
}
