//! The label of a file of the cache, and its name.

/// The first bytes of each file, as a number: a machine that holds numbers otherwise reads another one.
pub(super) const MAGIC: u64 = u64::from_le_bytes(*b"swlcache");

/// Counts up where the same version of the program begins to keep something else.
pub(super) const FORMAT: u32 = 1;

/// Start and end of the names.
pub(super) const NAME: (&str, &str) = ("prepared-", ".swlcache");

/// The label of a file with a key: the magic number, the format, and the key.
pub(super) fn label(key: &[u8; 32]) -> Vec<u8> {
    let mut label = MAGIC.to_ne_bytes().to_vec();
    label.extend(FORMAT.to_ne_bytes());
    label.extend(key);
    label
}

/// The name of a file with a key.
pub(super) fn name(key: &[u8; 32]) -> String {
    let digits: String = key.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("{}{digits}{}", NAME.0, NAME.1)
}
