//! Dermatome's host side in one: every module of the crates under `host/`, by name.
//!
//! Data flows one way: [`skin`] file -> [`mesh`] -> [`forward`] model -> [`jacobian`] -> [`inverse`]
//! (reconstruction matrix) -> [`quantize`] (patch) -> [`link`] -> board -> image -> contacts. A program that needs
//! only a part of it depends on that crate instead: `dermatome-link` talks to a board without a finite-element model.
#![forbid(unsafe_code)]

pub use dermatome_body as body;
pub use dermatome_experiments::{evaluate, experiment, presses, scenes, trust};
pub use dermatome_frames::{array, calibrate, interchange, learn, recorded};
pub use dermatome_geometry::{cut, embedding, mesh, outline, sheet};
pub use dermatome_link as link;
pub use dermatome_link::{health, scope};
pub use dermatome_messages as messages;
pub use dermatome_model::{
    forward, inverse, jacobian, metrics, model, multi_contact, pixels, prior, quantize, skin, stimulation,
};
#[cfg(feature = "command")]
pub use dermatome_page as page;
pub use dermatome_patch as patch;
pub use dermatome_patch::output;
pub use dermatome_recording as recording;
pub use dermatome_shared as shared;
pub use dermatome_simulate as simulate;
pub use dermatome_simulate::material;
pub use dermatome_urdf as urdf;
pub use dermatome_view as view;
