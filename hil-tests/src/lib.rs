//! Runs the firmware against a rig, which is an emulated board or a real one.
//!
//! **Nothing runs yet**: this crate is a place with a purpose, which its README describes.
