//! Why nothing can be added to a description.

/// Names that an error lists at most.
const MOST_NAMES: usize = 40;

/// Why a description cannot be used, or takes no skin.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DescriptionError {
    /// It is no XML.
    #[error("it is no XML: {reason}")]
    Syntax {
        /// Why, with line and column.
        reason: String,
    },
    /// XML of another kind.
    #[error("its outermost element is <{found}>; allowed: {allowed}")]
    Root {
        /// What it is.
        found: String,
        /// What it may be.
        allowed: &'static str,
    },
    /// A program that makes a URDF, and none itself.
    #[error(
        "line {line}: {what} is xacro, from which a URDF is yet to be made; allowed: a URDF, such as `xacro FILE > robot.urdf` writes"
    )]
    Xacro {
        /// Where.
        line: u32,
        /// What shows it.
        what: String,
    },
    /// A link or body is not there.
    #[error("there is no {kind} {name:?}; allowed for `{kind}`: {allowed}")]
    Absent {
        /// What it would be.
        kind: &'static str,
        /// Its name.
        name: String,
        /// Those that are there.
        allowed: String,
    },
    /// A skin of this name is there already.
    #[error("line {line}: skin {name:?} is there already; allowed: another `name`, or `replace`")]
    Skin {
        /// Where.
        line: u32,
        /// Its name.
        name: String,
    },
    /// Something else has a name that the skin needs.
    #[error(
        "line {line}: there is a {kind} {name:?} already, which is not this skin's; allowed: another `name`"
    )]
    Taken {
        /// Where.
        line: u32,
        /// What it is.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// Something lies on the skin that is to be replaced.
    #[error(
        "line {line}: {kind} {name:?} holds more than the skin, which would go with it; allowed: to move that elsewhere first"
    )]
    Inhabited {
        /// Where.
        line: u32,
        /// What it is.
        kind: &'static str,
        /// Its name.
        name: String,
    },
}

impl DescriptionError {
    pub(crate) fn absent<'a>(kind: &'static str, name: &str, there: impl Iterator<Item = &'a str>) -> Self {
        Self::Absent { kind, name: name.to_owned(), allowed: names(there) }
    }
}

/// Names as an error lists them.
pub(crate) fn names<'a>(mut names: impl Iterator<Item = &'a str>) -> String {
    let shown: Vec<_> = names.by_ref().take(MOST_NAMES).map(|name| format!("{name:?}")).collect();
    match names.count() {
        0 if shown.is_empty() => "none".to_owned(),
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}
