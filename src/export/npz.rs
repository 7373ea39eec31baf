//! NumPy archives: arrays in the format NPY 1.0, stored without compression in a ZIP file.
//!
//! NEP 1, "A simple file format for NumPy arrays", R. Kern 2007.

use std::io::{Cursor, Write};
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// An archive as it grows: its files, each with its content.
#[derive(Default)]
pub(super) struct Archive {
    files: Vec<(String, Vec<u8>)>,
}

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
        self.files.push((format!("{name}.npy"), file));
    }

    /// The bytes of the archive. All files are of 1 January 1980, so those of equal content are equal.
    pub(super) fn finish(self) -> ZipResult<Vec<u8>> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in self.files {
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Stored)
                .last_modified_time(DateTime::default())
                .large_file(u32::try_from(content.len()).is_err());
            archive.start_file(name, options)?;
            archive.write_all(&content)?;
        }
        archive.finish().map(Cursor::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_begin_at_multiples_of_64_bytes() {
        let mut archive = Archive::default();
        archive.floats("a", &[2, 1], &[1.0, 2.0]);
        let bytes = archive.finish().expect("an archive");
        let mut read = zip::ZipArchive::new(Cursor::new(bytes)).expect("an archive");
        let mut bytes = Vec::new();
        let mut file = read.by_name("a.npy").expect("a file");
        std::io::Read::read_to_end(&mut file, &mut bytes).expect("its content");
        assert_eq!(&bytes[..6], b"\x93NUMPY");
        let header = usize::from(bytes[8]) + 256 * usize::from(bytes[9]);
        assert_eq!((10 + header) % 64, 0);
        let values = 10 + header;
        assert_eq!(&bytes[values..values + 4], 1.0f32.to_le_bytes());
    }
}
