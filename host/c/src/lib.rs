//! Dermatome for C and C++: contacts of a skin in a controller's loop.
//!
//! The functions are those of `include/dermatome.h`, which is made of this crate's sources (`tests/header.rs`); docs/c.md says
//! how to build and link, and shows a loop. Each function of [`functions`] does three things: it takes what the caller gave
//! ([`memory`]), lets a [`board::Board`] do it, and turns a failure into a code and words ([`failure`]). Nothing of what
//! a board is or does is decided here: that is `dermatome-link`'s.
//!
//! # Safety
//! What a caller promises is the same for all functions, and stands at the head of the header: a handle is one that
//! `dermatome_open` gave and that is not closed, one thread at a time uses it, pointers are null or lead to as much as
//! the size says, and text that goes in ends with a NUL.
#![expect(unsafe_code, reason = "a caller in C gives pointers, and finds functions by their names")]
#![expect(clippy::missing_safety_doc, reason = "the promise of all callers stands once, above")]

pub mod board;
pub mod codes;
pub mod failure;
pub mod functions;
pub mod memory;
pub mod records;
pub mod words;
