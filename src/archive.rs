//! Lists of plain numbers in a file, one after another, with a checksum at the end; read again with every length checked.
//!
//! ```text
//!  label (as long as whoever writes it says) │ number │ list: its length, then its items │ … │ BLAKE3 of all before
//! ```
//!
//! Numbers stand as the machine holds them; a label should begin with a number that another machine would read otherwise.
//! The checksum is compared before the first list is read, and no list is given room before it is known to lie in the file.

use bytemuck::{NoUninit, Pod};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};

/// Bytes of the checksum.
pub const CHECKSUM: u64 = 32;

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 18;

/// A file in the making.
pub struct ArchiveWriter<'a> {
    out: BufWriter<&'a mut dyn Write>,
    hasher: blake3::Hasher,
}

impl<'a> ArchiveWriter<'a> {
    /// Begins with a label.
    ///
    /// # Errors
    /// What the system refuses, here and in all that follows.
    pub fn new(out: &'a mut dyn Write, label: &[u8]) -> io::Result<ArchiveWriter<'a>> {
        let mut writer = ArchiveWriter {
            out: BufWriter::with_capacity(BLOCK, out),
            hasher: blake3::Hasher::new(),
        };
        writer.bytes(label)?;
        Ok(writer)
    }

    /// Writes a number.
    pub fn number(&mut self, number: u64) -> io::Result<()> {
        self.bytes(&number.to_ne_bytes())
    }

    /// Writes a list and its length.
    pub fn list<T: NoUninit>(&mut self, list: &[T]) -> io::Result<()> {
        self.number(list.len() as u64)?;
        self.bytes(bytemuck::cast_slice(list))
    }

    /// Writes what each item of a list has of something.
    pub fn column<S, T: NoUninit>(&mut self, list: &[S], of: impl Fn(&S) -> T) -> io::Result<()> {
        let column: Vec<T> = list.iter().map(of).collect();
        self.list(&column)
    }

    /// Ends with the checksum.
    pub fn finish(mut self) -> io::Result<()> {
        let checksum = self.hasher.finalize();
        self.out.write_all(checksum.as_bytes())?;
        self.out.flush()
    }

    fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hasher.update(bytes);
        self.out.write_all(bytes)
    }
}

/// A whole file, to be read from the end of its label on. Errors are words on what is wrong with it.
pub struct ArchiveReader {
    file: BufReader<File>,
    /// Bytes up to the checksum.
    left: u64,
}

impl ArchiveReader {
    /// Opens a file with this label, once its checksum has been found to be right.
    ///
    /// # Errors
    /// Words on a file of another label, one that is cut short, and one whose bytes are others than those written.
    pub fn open(file: File, label: &[u8]) -> Result<ArchiveReader, String> {
        let told = |error: io::Error| error.to_string();
        let length = file.metadata().map_err(told)?.len();
        let mut file = BufReader::with_capacity(BLOCK, file);
        let mut first = vec![0; label.len()];
        let whole = length >= label.len() as u64 + CHECKSUM;
        if !whole || file.read_exact(&mut first).is_err() {
            return Err("it is too short".into());
        }
        if first != label {
            return Err("it is of another kind or version, or of something else".into());
        }
        let mut hasher = blake3::Hasher::new();
        hasher.update(label);
        let left = length - CHECKSUM - label.len() as u64;
        let read = io::copy(&mut (&mut file).take(left), &mut hasher).map_err(told)?;
        let mut checksum = [0; CHECKSUM as usize];
        file.read_exact(&mut checksum).map_err(told)?;
        if read != left || hasher.finalize() != checksum {
            return Err("its checksum is wrong: it is cut short or damaged".into());
        }
        let start = SeekFrom::Start(label.len() as u64);
        file.seek(start).map_err(told)?;
        Ok(ArchiveReader { file, left })
    }

    /// Reads a number.
    pub fn number(&mut self) -> Result<u64, String> {
        let mut bytes = [0; size_of::<u64>()];
        self.bytes(&mut bytes)?;
        Ok(u64::from_ne_bytes(bytes))
    }

    /// Reads a list, however long.
    pub fn list<T: Pod>(&mut self) -> Result<Vec<T>, String> {
        let count = self.number()?;
        let bytes = count.checked_mul(size_of::<T>() as u64);
        if bytes.is_none_or(|bytes| bytes > self.left) {
            return Err(format!("a list of {count} items is longer than the file"));
        }
        let mut list = vec![T::zeroed(); count as usize];
        self.bytes(bytemuck::cast_slice_mut(&mut list))?;
        Ok(list)
    }

    /// Reads a list of so many items.
    pub fn list_of<T: Pod>(&mut self, count: usize) -> Result<Vec<T>, String> {
        let list = self.list()?;
        check(list.len() == count, "a list of another length")?;
        Ok(list)
    }

    /// Reads the starts of `rows` rows that lie one after another, and the end of the last.
    pub fn starts(&mut self, rows: usize) -> Result<Vec<u32>, String> {
        let starts: Vec<u32> = self.list_of(rows + 1)?;
        check(starts[0] == 0 && starts.is_sorted(), "rows out of order")?;
        Ok(starts)
    }

    /// Insists that nothing is left.
    pub fn finish(self) -> Result<(), String> {
        check(self.left == 0, "more than was to be read")
    }

    fn bytes(&mut self, bytes: &mut [u8]) -> Result<(), String> {
        let left = self.left.checked_sub(bytes.len() as u64);
        self.left = left.ok_or("it ends too early")?;
        let read = self.file.read_exact(bytes);
        read.map_err(|error| error.to_string())
    }
}

/// Insists on something; `wrong` are words on the opposite.
pub fn check(holds: bool, wrong: &str) -> Result<(), String> {
    match holds {
        true => Ok(()),
        false => Err(format!("it holds {wrong}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written() -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = ArchiveWriter::new(&mut bytes, b"label").expect("memory");
        writer.number(7).expect("memory");
        writer.list(&[1.5f32, -0.0, f32::NAN]).expect("memory");
        writer
            .column(&[(1, 2u16), (3, 4)], |pair| pair.1)
            .expect("memory");
        writer.finish().expect("memory");
        bytes
    }

    fn open(bytes: &[u8]) -> Result<ArchiveReader, String> {
        let mut file = tempfile::tempfile().expect("a file");
        file.write_all(bytes).expect("a file");
        file.rewind().expect("a file");
        ArchiveReader::open(file, b"label")
    }

    #[test]
    fn what_is_written_is_read_bit_for_bit() {
        let mut reader = open(&written()).expect("a file");
        assert_eq!(reader.number(), Ok(7));
        let floats: Vec<f32> = reader.list().expect("a list");
        let bits: Vec<u32> = floats.iter().map(|x| x.to_bits()).collect();
        assert_eq!(bits, [1.5f32, -0.0, f32::NAN].map(f32::to_bits));
        assert_eq!(reader.list_of::<u16>(2), Ok(vec![2, 4]));
        assert_eq!(reader.finish(), Ok(()));
    }

    #[test]
    fn no_file_of_other_bytes_is_opened() {
        let whole = written();
        for length in 0..whole.len() {
            assert!(open(&whole[..length]).is_err(), "{length}");
        }
        for at in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 1;
            assert!(open(&damaged).is_err(), "{at}");
        }
        let longer = [&whole[..], b"x"].concat();
        assert!(open(&longer).is_err());
    }

    #[test]
    fn a_length_beyond_the_file_takes_no_memory() {
        let mut bytes = Vec::new();
        let mut writer = ArchiveWriter::new(&mut bytes, b"label").expect("memory");
        writer.number(u64::MAX / 2).expect("memory");
        writer.number(1 << 40).expect("memory");
        writer.finish().expect("memory");
        for skipped in 0..2 {
            let mut reader = open(&bytes).expect("a file");
            (0..skipped).for_each(|_| drop(reader.number()));
            let told = reader.list::<u64>().expect_err("too long");
            assert!(told.ends_with("longer than the file"), "{told}");
        }
    }
}
