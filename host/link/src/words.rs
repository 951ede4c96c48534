//! Words of others, as text and nothing else: what would steer a terminal is escaped.

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
