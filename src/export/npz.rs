//! NumPy archives: arrays in the format NPY 1.0, stored without compression in a ZIP file.
//!
//! NEP 1, "A simple file format for NumPy arrays", R. Kern 2007; PKWARE, "APPNOTE.TXT", sections 4.3.7 to 4.3.16.

/// An archive as it grows.
#[derive(Default)]
pub(super) struct Archive {
    /// Local headers with their files.
    bytes: Vec<u8>,
    /// The directory at the end.
    directory: Vec<u8>,
    files: u16,
}

/// 1 January 1980, the first day that ZIP knows: files of equal content are equal.
const DAY: u16 = (1 << 5) | 1;

/// The version of ZIP that readers need.
const VERSION: u16 = 20;

impl Archive {
    /// Adds an array of 32-bit floats.
    pub(super) fn floats(&mut self, name: &str, shape: &[usize], values: &[f32]) {
        let bytes = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        self.array(name, "<f4", shape, bytes);
    }

    /// Adds a row of whole numbers.
    pub(super) fn numbers(&mut self, name: &str, values: &[u32]) {
        let bytes = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        self.array(name, "<u4", &[values.len()], bytes);
    }

    /// Adds a row of texts.
    pub(super) fn texts(&mut self, name: &str, values: &[String]) {
        let longest = values.iter().map(|text| text.chars().count()).max();
        let longest = longest.unwrap_or(0).max(1);
        let mut bytes = Vec::new();
        for text in values {
            let letters = text.chars().map(u32::from).chain(std::iter::repeat(0));
            bytes.extend(letters.take(longest).flat_map(u32::to_le_bytes));
        }
        self.array(name, &format!("<U{longest}"), &[values.len()], bytes);
    }

    fn array(&mut self, name: &str, kind: &str, shape: &[usize], values: Vec<u8>) {
        let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
        let mut header =
            format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
        // The array begins at a multiple of 64 bytes.
        let length = 10 + header.len() + 1;
        header += &" ".repeat(length.next_multiple_of(64) - length);
        header.push('\n');
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((header.len() as u16).to_le_bytes());
        file.extend(header.bytes());
        file.extend(values);
        self.file(&format!("{name}.npy"), &file);
    }

    fn file(&mut self, name: &str, content: &[u8]) {
        let offset = self.bytes.len() as u32;
        let mut common = Vec::new();
        for word in [VERSION, 0, 0, 0, DAY] {
            common.extend(word.to_le_bytes());
        }
        let length = content.len() as u32;
        for word in [crc(content), length, length] {
            common.extend(word.to_le_bytes());
        }
        common.extend((name.len() as u16).to_le_bytes());
        common.extend(0u16.to_le_bytes());
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&common);
        self.bytes.extend(name.bytes());
        self.bytes.extend(content);
        self.directory.extend(b"PK\x01\x02");
        self.directory.extend(VERSION.to_le_bytes());
        self.directory.extend(&common);
        self.directory.extend([0; 10]);
        self.directory.extend(offset.to_le_bytes());
        self.directory.extend(name.bytes());
        self.files += 1;
    }

    /// The archive.
    pub(super) fn finish(mut self) -> Vec<u8> {
        let start = self.bytes.len() as u32;
        let length = self.directory.len() as u32;
        self.bytes.append(&mut self.directory);
        self.bytes.extend(b"PK\x05\x06\0\0\0\0");
        for _ in 0..2 {
            self.bytes.extend(self.files.to_le_bytes());
        }
        self.bytes.extend(length.to_le_bytes());
        self.bytes.extend(start.to_le_bytes());
        self.bytes.extend([0; 2]);
        self.bytes
    }
}

/// The check sum CRC-32 of ISO 3309.
fn crc(bytes: &[u8]) -> u32 {
    let table: Vec<u32> = (0..256u32)
        .map(|byte| {
            (0..8).fold(byte, |rest, _| {
                let odd = if rest & 1 == 1 { 0xEDB8_8320 } else { 0 };
                (rest >> 1) ^ odd
            })
        })
        .collect();
    let sum = bytes.iter().fold(u32::MAX, |sum, byte| {
        table[usize::from(sum as u8 ^ byte)] ^ (sum >> 8)
    });
    !sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_sum_is_the_known_one() {
        assert_eq!(crc(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn arrays_begin_at_multiples_of_64_bytes() {
        let mut archive = Archive::default();
        archive.floats("a", &[2, 1], &[1.0, 2.0]);
        let bytes = archive.finish();
        let at = 30 + "a.npy".len();
        assert_eq!(&bytes[at..at + 6], b"\x93NUMPY");
        let header = usize::from(bytes[at + 8]) + 256 * usize::from(bytes[at + 9]);
        assert_eq!((10 + header) % 64, 0);
        let values = at + 10 + header;
        assert_eq!(&bytes[values..values + 4], 1.0f32.to_le_bytes());
    }
}
