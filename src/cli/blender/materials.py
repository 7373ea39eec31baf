# Materials: what of their nodes glTF has a word for, in each sampled frame.


class Colour:
    """What a socket is given: a factor, and what multiplies it."""

    def __init__(self, factor, image=None, attribute=None):
        self.factor = np.array(factor, float)
        self.image = image
        self.attribute = attribute

    def is_even(self):
        return self.image is None and self.attribute is None

    def times(self, other):
        return Colour(self.factor * other.factor, self.image or other.image, self.attribute or other.attribute)


class Surface:
    """What of a material comes over."""

    def __init__(self, base, emission, alpha=1.0, metallic=0.0, transmission=0.0, normal=None, roughness=1.0, ior=1.5, coat=(0.0, 0.0)):
        self.roughness = roughness
        self.ior = ior
        # A clear coat's strength and roughness.
        self.coat = coat
        self.base = base
        self.emission = emission
        self.alpha = alpha
        self.metallic = metallic
        self.transmission = transmission
        self.normal = normal


BLACK = (0.0, 0.0, 0.0)
GREY = (0.8, 0.8, 0.8)


class Reader:
    """Reads a material's nodes; what does not come over is noted."""

    def __init__(self, material, notes):
        self.material = material
        self.notes = notes

    def lost(self, text):
        self.notes.add(f"{self.material.name}: {text}")

    def surface(self):
        tree = self.material.node_tree
        if tree is None or not getattr(self.material, "use_nodes", True):
            return Surface(Colour(self.material.diffuse_color[:3]), Colour(BLACK))
        output = tree.get_output_node("CYCLES")
        if output is None:
            return Surface(Colour(BLACK), Colour(BLACK))
        for name, text in (("Volume", "its volume"), ("Displacement", "its displacement")):
            if output.inputs[name].is_linked:
                self.lost(f"{text} is left out")
        return self.shader(source(output.inputs["Surface"]))

    def shader(self, node):
        """The surface of a shader node."""
        if node is None:
            return Surface(Colour(BLACK), Colour(BLACK))
        if node.type == "BSDF_PRINCIPLED":
            return self.principled(node)
        if node.type == "EMISSION":
            strength = self.number(node.inputs["Strength"])
            return Surface(Colour(BLACK), self.colour(node.inputs["Color"]).times(Colour([strength] * 3)))
        if node.type == "BSDF_TRANSPARENT":
            return Surface(Colour(BLACK), Colour(BLACK), alpha=0.0)
        if node.type in {"BSDF_GLASS", "BSDF_GLOSSY"}:
            clear = node.type == "BSDF_GLASS"
            ior = self.number(node.inputs["IOR"]) if clear else 1.5
            roughness = self.number(node.inputs["Roughness"])
            colour, ways = self.colour(node.inputs["Color"]), (0.0, 1.0) if clear else (1.0, 0.0)
            return Surface(colour, Colour(BLACK), 1.0, *ways, roughness=roughness, ior=ior)
        if node.type in {"MIX_SHADER", "ADD_SHADER"}:
            return self.both(node)
        if node.type != "BSDF_DIFFUSE":
            self.lost(f"{node.bl_label} is rendered matt, in its own colour")
        inputs = node.inputs
        return Surface(self.colour(inputs["Color"]) if "Color" in inputs else Colour(GREY), Colour(BLACK))

    def both(self, node):
        """Two shaders, mixed by a number or added."""
        one, other = (self.shader(source(socket)) for socket in node.inputs if socket.type == "SHADER")
        share = self.number(node.inputs[0]) if node.type == "MIX_SHADER" else None
        ways = (1.0, 1.0) if share is None else (1 - share, share)
        parts = [self.sum(a, b, ways) for a, b in ((one.base, other.base), (one.emission, other.emission))]
        return Surface(*parts, alpha=ways[0] * one.alpha + ways[1] * other.alpha if share is not None else one.alpha)

    def sum(self, one, other, ways):
        one, other = one.times(Colour([ways[0]] * 3)), other.times(Colour([ways[1]] * 3))
        if not other.factor.any():
            return one
        if not one.factor.any():
            return other
        if not (one.is_even() and other.is_even()):
            self.lost("of two mixed textures the first stands for both")
        return Colour(one.factor + other.factor, one.image or other.image, one.attribute or other.attribute)

    def principled(self, node):
        inputs = node.inputs
        strength = self.number(inputs["Emission Strength"])
        emission = self.colour(inputs["Emission Color"]) if strength > 0 else Colour(BLACK)
        alpha = inputs["Alpha"]
        holes = source(alpha)
        if holes is not None and holes.type != "TEX_IMAGE":
            self.lost(f"its alpha from {holes.bl_label} is left out")
        return Surface(
            self.colour(inputs["Base Color"]),
            emission.times(Colour([strength] * 3)),
            0.999 if holes is not None and holes.type == "TEX_IMAGE" else alpha.default_value,
            # Only the share is told of a textured metal: it changes the warning alone.
            inputs["Metallic"].default_value if not inputs["Metallic"].is_linked else 1.0,
            self.number(inputs["Transmission Weight"]),
            self.bumps(source(inputs["Normal"])),
            # What is mirror here and matt there is matt.
            1.0 if inputs["Roughness"].is_linked or inputs["Metallic"].is_linked else inputs["Roughness"].default_value,
            self.number(inputs["IOR"]),
            (self.number(inputs["Coat Weight"]), self.number(inputs["Coat Roughness"])),
        )

    def bumps(self, node):
        """The normal map's image node and strength."""
        image = source(node.inputs["Color"]) if node is not None and node.type == "NORMAL_MAP" else None
        if image is not None and image.type == "TEX_IMAGE" and image.image:
            return image, self.number(node.inputs["Strength"])
        if node is not None:
            self.lost(f"{node.bl_label} at its normal is left out")
        return None

    def number(self, socket):
        node = source(socket)
        if node is not None and node.type == "VALUE":
            return node.outputs[0].default_value
        if node is not None:
            self.lost(f"{node.bl_label} at {socket.name} is left out, its own number stands")
        return socket.default_value

    def colour(self, socket):
        """What a colour socket is given."""
        node = source(socket)
        if node is None:
            return Colour(socket.default_value[:3])
        if node.type == "RGB":
            return Colour(node.outputs[0].default_value[:3])
        if node.type == "TEX_IMAGE" and node.image is not None:
            return Colour((1, 1, 1), image=node)
        if node.type == "VERTEX_COLOR":
            return Colour((1, 1, 1), attribute=node.layer_name)
        if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY":
            return Colour((1, 1, 1), attribute=node.attribute_name)
        if node.type in {"MIX", "MIX_RGB"}:
            return self.mixed(node, socket)
        self.lost(f"{node.bl_label} at {socket.name} is left out, the socket's own colour stands")
        return Colour(socket.default_value[:3])

    def mixed(self, node, socket):
        inputs = [s for s in node.inputs if s.enabled and s.type == "RGBA"]
        share = next(s for s in node.inputs if s.enabled and s.type == "VALUE")
        share = self.number(share)
        one, other = (self.colour(s) for s in inputs[:2])
        if node.blend_type == "MULTIPLY" and (share == 1.0 or one.is_even() and other.is_even()):
            return one.times(Colour(1 + share * (other.factor - 1), other.image, other.attribute))
        if node.blend_type == "MIX":
            return self.sum(one, other, (1 - share, share))
        self.lost(f"Mix of kind {node.blend_type} at {socket.name} is left out, its first colour stands")
        return one


def source(socket):
    """The node that feeds a socket, past reroutes and muted nodes."""
    while socket.is_linked:
        node = socket.links[0].from_node
        if node.type == "REROUTE":
            socket = node.inputs[0]
        else:
            return node
    return None


class Paint:
    """A material in each sampled frame."""

    def __init__(self, material, frames):
        self.original = material.original if material else None
        self.culls = bool(material and material.use_backface_culling)
        tree = self.original.node_tree if self.original else None
        self.lives = bool(self.original and (self.original.animation_data or tree and tree.animation_data))
        self.values = [None] * frames
        self.now = None

    def take(self, at, depsgraph, notes):
        if self.now is None or self.lives:
            plain = Surface(Colour(GREY), Colour(BLACK))
            self.now = Reader(self.original.evaluated_get(depsgraph), notes).surface() if self.original else plain
        base = np.append(np.clip(self.now.base.factor, 0, 1), np.clip(self.now.alpha, 0, 1))
        self.values[at] = {"base": base, "glow": np.maximum(self.now.emission.factor, 0)}
