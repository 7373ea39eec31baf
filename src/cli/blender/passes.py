# Passes: layers of sweeplight's files as Blender means them.

VERSION_5 = bpy.app.version >= (5, 0, 0)

# Passes: name before Blender 5 and since, channels, kind, the view layer's property, layers of the file.
PASSES = [
    ("Depth", "Depth", "Z", "VALUE", "use_pass_z", ["depth"]),
    ("Normal", "Normal", "XYZ", "VECTOR", "use_pass_normal", ["normal"]),
    ("DiffDir", "Diffuse Direct", "RGB", "COLOR", "use_pass_diffuse_direct", ["direct", "albedo"]),
    ("DiffInd", "Diffuse Indirect", "RGB", "COLOR", "use_pass_diffuse_indirect", ["indirect", "albedo"]),
    ("DiffCol", "Diffuse Color", "RGB", "COLOR", "use_pass_diffuse_color", ["albedo"]),
    ("Emit", "Emission", "RGB", "COLOR", "use_pass_emit", ["emission"]),
    ("IndexOB", "Object Index", "X", "VALUE", "use_pass_object_index", ["object"]),
    ("Denoising Albedo", "Denoising Albedo", "RGB", "COLOR", "sweeplight_denoising_data", ["albedo"]),
    ("Denoising Normal", "Denoising Normal", "XYZ", "VECTOR", "sweeplight_denoising_data", ["normal"]),
    ("Denoising Depth", "Denoising Depth", "Z", "VALUE", "sweeplight_denoising_data", ["depth"]),
]


class Pass:
    """A pass that a view layer asks for."""

    def __init__(self, old, new, channels, kind, switch, layers):
        self.name = new if VERSION_5 else old
        self.title, self.channels, self.kind, self.switch, self.layers = new, channels, kind, switch, layers

    def picture(self, channels, objects):
        """Its values, height × width × channels, of the channels of a file."""
        layer = self.layers[0]
        if layer == "depth":
            return channels["depth.Z"][..., None]
        if layer == "object":
            numbers = np.zeros(max(objects, default=0) + 1, np.float32)
            numbers[list(objects)] = list(objects.values())
            seen = channels["object.X"].astype(int)
            return np.where(seen >= 0, numbers[seen], 0)[..., None]
        if layer == "normal":
            x, y, z = (channels[f"normal.{axis}"] for axis in "XYZ")
            return np.stack([x, -z, y], axis=2)
        light = rgb(channels, layer)
        if len(self.layers) == 1:
            return light
        # Blender's passes hold light before it is reflected: times the colour it is what the picture shows.
        albedo = rgb(channels, self.layers[1])
        return np.divide(light, albedo, out=np.zeros_like(light), where=albedo > 0)


def rgb(channels, layer):
    return np.stack([channels[f"{layer}.{c}" if layer else c] for c in "RGB"], axis=2)


def passes_of(view_layer):
    return [p for p in (Pass(*row) for row in PASSES) if getattr(view_layer, p.switch)]
