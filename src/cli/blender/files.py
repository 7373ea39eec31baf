# Files: the pictures that sweeplight writes, and those that it reads.


def read_exr(path):
    """Channels by name of an EXR of 32-bit floats in ZIP blocks, each height × width, the top row first."""
    with open(path, "rb") as file:
        data = file.read()
    head, at = {}, 8
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        head[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    names, left = [], head[b"channels"]
    while left[0]:
        name, left = left.split(b"\0", 1)
        names.append(name.decode())
        left = left[16:]
    x0, y0, x1, y1 = struct.unpack("<4i", head[b"dataWindow"])
    width, height, rows = x1 - x0 + 1, y1 - y0 + 1, 16
    picture = np.empty((height, len(names), width), np.float32)
    starts = struct.unpack_from(f"<{-(-height // rows)}Q", data, at + 1)
    for start in starts:
        y, size = struct.unpack_from("<ii", data, start)
        block = picture[y - y0 : y - y0 + rows]
        block[...] = unzip(data[start + 8 : start + 8 + size], block.nbytes).view("<f4").reshape(block.shape)
    return {name: picture[:, index] for index, name in enumerate(names)}


def unzip(packed, size):
    """The bytes of a ZIP block: differences of neighbours, even bytes before odd ones."""
    if len(packed) == size:
        return np.frombuffer(packed, np.uint8)
    bytes_ = np.frombuffer(zlib.decompress(packed), np.uint8).copy()
    bytes_[1:] -= 128
    bytes_ = np.cumsum(bytes_, dtype=np.uint8)
    both = np.empty(size, np.uint8)
    both[0::2], both[1::2] = bytes_[: (size + 1) // 2], bytes_[(size + 1) // 2 :]
    return both


def pixels_of(image):
    """An image's pixels, height × width × 4, the top row first."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)[::-1]
    if image.channels < 3:
        pixels = np.repeat(pixels[..., :1], 3, axis=2)
    if pixels.shape[2] == 3:
        pixels = np.concatenate([pixels, np.ones_like(pixels[..., :1])], axis=2)
    return pixels


def png(image):
    """An image as a PNG: of a picture's own values, or of a linear one's in sRGB."""
    pixels = pixels_of(image)
    if image.is_float:
        linear = np.clip(pixels[..., :3], 0, 1)
        curved = np.where(linear < 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
        pixels = np.concatenate([curved, pixels[..., 3:]], axis=2)
    codes = np.rint(np.clip(pixels, 0, 1) * 255).astype(np.uint8)
    height, width = codes.shape[:2]
    lines = np.concatenate([np.zeros((height, 1), np.uint8), codes.reshape(height, -1)], axis=1)

    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    head = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines.tobytes(), 1)) + chunk(b"IEND", b"")


def write_hdr(path, radiance):
    """Writes height × width × 3 of radiance as a Radiance picture."""
    most = np.maximum(radiance.max(axis=2), 1e-32)
    exponent = np.frexp(most)[1]
    mantissa = np.clip(radiance * np.ldexp(256.0, -exponent)[..., None], 0, 255)
    codes = np.concatenate([mantissa, exponent[..., None] + 128], axis=2).astype(np.uint8)
    with open(path, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % radiance.shape[:2])
        file.write(codes.tobytes())


class Glb:
    """A glTF file that grows: lists of the JSON, and the binary chunk."""

    def __init__(self):
        self.json = {"asset": {"version": "2.0", "generator": "sweeplight for Blender"}, "extensionsUsed": []}
        self.binary = bytearray()

    def add(self, name, item):
        """Appends to a list of the JSON; returns the place."""
        items = self.json.setdefault(name, [])
        items.append(item)
        return len(items) - 1

    def uses(self, extension):
        if extension not in self.json["extensionsUsed"]:
            self.json["extensionsUsed"].append(extension)
        return extension

    def bytes(self, data):
        """Bytes as a buffer view."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        place = self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data
        return place

    def numbers(self, array, bounds=False):
        """An accessor of an array: rows of it are vectors."""
        codes = {"f": 5126, "I": 5125, "B": 5121}
        array = np.ascontiguousarray(array)
        kind = "SCALAR" if array.ndim == 1 else f"VEC{array.shape[1]}"
        accessor = {"bufferView": self.bytes(array.tobytes()), "componentType": codes[array.dtype.char], "count": len(array), "type": kind}
        if bounds:
            flat = array.reshape(len(array), -1)
            accessor.update(min=flat.min(axis=0).tolist(), max=flat.max(axis=0).tolist())
        return self.add("accessors", accessor)

    def save(self, path):
        if not self.json["extensionsUsed"]:
            del self.json["extensionsUsed"]
        self.binary += b"\0" * (-len(self.binary) % 4)
        if self.binary:
            self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + (8 + len(self.binary) if self.binary else 0)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON") + text)
            if self.binary:
                file.write(struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary)
