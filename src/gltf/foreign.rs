//! Files that are no glTF, by their first bytes: what they are is told, and nothing of what they say.

/// Kinds of files: where the bytes stand, the bytes, and the name.
const KINDS: [(usize, &[u8], &str); 35] = [
    (0, b"Kaydara FBX Binary", "an FBX file"),
    (0, b"; FBX", "an FBX file"),
    (0, b"BLENDER", "a Blender file"),
    (
        0,
        b"\x28\xb5\x2f\xfd",
        "a file that is compressed by zstd, as Blender files are",
    ),
    (0, b"\x1f\x8b", "a file that is compressed by gzip"),
    (0, b"BZh", "a file that is compressed by bzip2"),
    (0, b"\xfd7zXZ", "a file that is compressed by xz"),
    (0, b"PK\x03\x04", "a ZIP archive"),
    (0, b"PK\x05\x06", "an empty ZIP archive"),
    (0, b"7z\xbc\xaf\x27\x1c", "a 7z archive"),
    (0, b"Rar!", "a RAR archive"),
    (257, b"ustar", "a tar archive"),
    (0, b"#usda", "a USD file"),
    (0, b"PXR-USDC", "a USD file"),
    (0, b"ply\n", "a PLY file"),
    (0, b"ply\r", "a PLY file"),
    (0, b"solid ", "an STL file"),
    (0, b"mtllib", "an OBJ file"),
    (0, b"v ", "an OBJ file"),
    (0, b"o ", "an OBJ file"),
    (0, b"#?R", "a Radiance picture"),
    (0, b"\x76\x2f\x31\x01", "an OpenEXR picture"),
    (0, b"\x89PNG", "a PNG picture"),
    (0, b"\xff\xd8\xff", "a JPEG picture"),
    (8, b"WEBP", "a WebP picture"),
    (0, b"\xabKTX 20\xbb", "a KTX2 picture"),
    (0, b"GIF8", "a GIF picture"),
    (0, b"BM", "a BMP picture"),
    (0, b"II*\0", "a TIFF picture"),
    (0, b"MM\0*", "a TIFF picture"),
    (0, b"%PDF", "a PDF document"),
    (4, b"ftyp", "a video or a picture of the MP4 family"),
    (0, b"\x7fELF", "a program"),
    (0, b"MZ", "a program"),
    (0, b"<", "an XML or HTML document, as COLLADA is"),
];

/// The kind of a file, in words.
pub(super) fn kind(bytes: &[u8]) -> &'static str {
    let start = bytes.trim_ascii_start();
    let starts = |(at, sign, _): &&(usize, &[u8], &str)| {
        let bytes = if *at == 0 { start } else { bytes };
        bytes.get(*at..).is_some_and(|rest| rest.starts_with(sign))
    };
    if let Some((.., kind)) = KINDS.iter().find(starts) {
        return kind;
    }
    // Modellers begin an OBJ file with a comment; the first line that is none decides.
    let mut lines = start.split(|byte| *byte == b'\n');
    let line = lines
        .find(|line| !line.starts_with(b"#"))
        .unwrap_or_default();
    let object = [&b"mtllib "[..], b"o ", b"g ", b"v "];
    if start.starts_with(b"#") && object.iter().any(|sign| line.starts_with(sign)) {
        return "an OBJ file";
    }
    match std::str::from_utf8(&bytes[..bytes.len().min(LOOKED_AT)]) {
        Ok(text) if !text.contains('\0') => "text of another kind",
        Err(fault) if fault.error_len().is_none() => "text of another kind",
        _ => "a binary file of another kind",
    }
}

/// Bytes that tell text from what is none.
const LOOKED_AT: usize = 512;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_told_by_their_first_bytes() {
        for (bytes, expected) in [
            (&b"\x89PNG\r\n\x1a\n"[..], "a PNG picture"),
            (b"PK\x03\x04secret", "a ZIP archive"),
            (b"BLENDER-v300", "a Blender file"),
            (b"Kaydara FBX Binary  \0", "an FBX file"),
            (b"# Blender\n# x\nmtllib a.mtl\n", "an OBJ file"),
            (b"v 0 0 0\n", "an OBJ file"),
            (b"\x1f\x8b\x08", "a file that is compressed by gzip"),
            (b"RIFF\0\0\0\0WEBP", "a WebP picture"),
            (b"<COLLADA>", "an XML or HTML document, as COLLADA is"),
            ("päss=1".as_bytes(), "text of another kind"),
            (b"\xff\x00\x01", "a binary file of another kind"),
            (b"a\0b", "a binary file of another kind"),
            (b"", "text of another kind"),
        ] {
            assert_eq!(kind(bytes), expected, "{bytes:?}");
        }
    }
}
