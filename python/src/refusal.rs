//! Errors of the libraries as exceptions; their sentence names the value.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(
    trendid,
    Refusal,
    PyValueError,
    "A record, a structure or a setting that cannot be used; the message names the value and what was expected."
);

/// The exception of an error.
pub(crate) fn refused(error: impl std::fmt::Display) -> PyErr {
    Refusal::new_err(error.to_string())
}

/// The exception of a word that is none of those offered.
pub(crate) fn unknown(what: &str, word: &str, offered: &str) -> PyErr {
    refused(format!("{what} is '{word}', expected {offered}"))
}
