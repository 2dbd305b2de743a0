//! The tracer: what rays read, and what they carry.
