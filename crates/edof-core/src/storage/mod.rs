//! Result files: written whole or not at all, identified by content, with a record of how they were made.
//!
//! | what | module |
//! |---|---|
//! | files that appear whole or not at all | [`atomic`] |
//! | a generated folder replaces only what it wrote itself | [`folder`] |
//! | SHA-256 of contents | [`digest`] |
//! | arrays in files of other programs (`.npz`, safetensors) | [`arrays`] |
//! | files that are read: regular ones only | [`input`] |
//! | JSON that a person wrote | [`json`] |
//! | names that files give to what they describe | [`name`] |
//! | command, version, inputs and machine behind a result | [`provenance`] |
//!
//! Formats of photographs and raw frames are in `edof-io`.

pub mod arrays;
pub mod atomic;
pub mod digest;
pub mod folder;
pub mod input;
pub mod json;
pub mod name;
pub mod provenance;
