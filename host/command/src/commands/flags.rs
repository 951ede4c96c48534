//! Errors of the library in the words of a command: its parameters by the flags that set them.

/// The error, with each of these texts replaced by the second of the pair; as it is if it holds none of them.
pub(super) fn in_flags(
    error: impl std::error::Error + Send + Sync + 'static,
    flags: &[(&str, &str)],
) -> anyhow::Error {
    let own = error.to_string();
    let told = flags.iter().fold(own.clone(), |text, (parameter, flag)| text.replace(parameter, flag));
    if told == own { error.into() } else { anyhow::Error::msg(told) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error)]
    #[error("`radius` is {0}; a smaller `edge_length` helps")]
    struct Wrong(f64);

    #[test]
    fn parameters_are_told_as_flags_and_other_errors_stay_themselves() {
        let flags = [("`radius`", "`--radius`"), ("`edge_length`", "`--edge-length`")];
        assert_eq!(
            in_flags(Wrong(2.0), &flags).to_string(),
            "`--radius` is 2; a smaller `--edge-length` helps"
        );
        assert!(in_flags(Wrong(2.0), &[("`width`", "`--width`")]).is::<Wrong>());
    }
}
