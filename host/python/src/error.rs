//! Error: what goes wrong in the crates, in their words.

use pyo3::{create_exception, exceptions::PyException, prelude::*};
use std::{fmt::Display, path::Path};

create_exception!(
    dermatome,
    Error,
    PyException,
    "What went wrong with a board, a file, or a skin: in the words of the command `dermatome`."
);

/// An error of the crates as an exception.
pub(crate) fn raised(error: impl Display) -> PyErr {
    Error::new_err(error.to_string())
}

/// The same of a skin file, which the error itself does not name.
pub(crate) fn of_skin_file(path: &Path) -> impl Fn(&dyn Display) -> PyErr + '_ {
    move |error| Error::new_err(format!("skin file `{}`: {error}", path.display()))
}
