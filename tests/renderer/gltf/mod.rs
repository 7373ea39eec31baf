//! A glTF file as it is read: what is refused, with which words, and within which bounds.

mod broken;
mod compressed;
mod limits;
mod losses;
mod mutated;
