//! The mixer as a person meets it.
