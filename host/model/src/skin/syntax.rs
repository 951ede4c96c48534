//! What the TOML reader says, in the words of who writes the file.

/// Its words for what was expected, and ours.
const WORDS: [(&str, &str); 3] = [
    ("expected i64", "expected a whole number"),
    ("expected f64", "expected a number"),
    ("expected a sequence", "expected a list"),
];

/// The error with line and column, the line itself, and what is allowed there.
#[must_use]
pub fn in_words(error: &toml::de::Error) -> String {
    let all = error.to_string();
    let place = all.trim_end().strip_suffix(error.message()).unwrap_or_default();
    let words =
        WORDS.iter().fold(error.message().to_owned(), |text, (theirs, ours)| text.replace(theirs, ours));
    match words.split_once("expected struct ") {
        Some((before, _)) => format!("{place}{before}expected a table"),
        None => format!("{place}{words}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[expect(dead_code, reason = "only read")]
    struct File {
        count: Option<i64>,
        size: Option<f64>,
        list: Option<Vec<i64>>,
        table: Option<Table>,
    }

    #[derive(Debug, Deserialize)]
    #[expect(dead_code, reason = "only read")]
    struct Table {
        inner: i64,
    }

    #[test]
    fn what_is_expected_is_said_in_words() {
        for (text, expected) in [
            ("count = 8.5", "invalid type: floating point `8.5`, expected a whole number"),
            ("count = \"8\"", "expected a whole number"),
            ("size = \"a\"", "expected a number"),
            ("list = 3", "expected a list"),
            ("table = 3", "invalid type: integer `3`, expected a table"),
        ] {
            let error = in_words(&toml::from_str::<File>(text).unwrap_err());
            assert!(error.contains("line 1") && error.contains(text) && error.ends_with(expected), "{error}");
        }
    }
}
