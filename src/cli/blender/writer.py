# The file: a stage as glTF, whose nodes stand in Blender's own coordinates.


class Writer:
    """Writes a stage as glTF: what changes becomes a track of one animation."""

    def __init__(self, stage, fps):
        self.stage = stage
        self.glb = Glb()
        first = stage.frames[0]
        self.times = np.array([(frame - first) / fps for frame in stage.frames], np.float32)
        # What jumps does so half a frame early: then no rounding of a time can show the frame before.
        self.jumps = np.maximum(self.times - 0.5 / fps, 0).astype(np.float32)
        self.inputs, self.channels, self.samplers = {}, [], []
        self.meshes, self.images, self.places = {}, {}, {}
        self.objects, self.triangles = {}, 0

    def write(self, path):
        # Write lists in an order that knows what refers to what.
        glb, stage = self.glb, self.stage
        turned = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1]
        root = {"name": "Blender", "matrix": turned}
        glb.add("nodes", root)
        children = root["children"] = [self.look()]
        for key, paint in stage.materials.items():
            self.places[key] = self.paint(key or "default", paint)
        for thing in stage.things.values():
            children.append(self.thing(thing))
        for lamp in stage.lamps.values():
            children.append(self.lamp(lamp))
        glb.add("scenes", {"nodes": [0] + self.focused()})
        glb.json["scene"] = 0
        if self.channels:
            glb.add("animations", {"name": "Blender", "channels": self.channels, "samplers": self.samplers})
        glb.save(path)

    def track(self, target, values, jumps=False):
        """A track of values, one row a sampled frame."""
        if jumps not in self.inputs:
            self.inputs[jumps] = self.glb.numbers(self.jumps if jumps else self.times, bounds=True)
        output = values if values.dtype == np.uint8 else values.astype(np.float32)
        way = "STEP" if jumps else "LINEAR"
        self.samplers.append({"input": self.inputs[jumps], "output": self.glb.numbers(output), "interpolation": way})
        self.channels.append({"sampler": len(self.samplers) - 1, "target": target})

    def point(self, pointer, values, jumps=False):
        """The same of a property that a pointer names, if it changes at all."""
        values = np.array(values)
        if np.ptp(values, axis=0).max() <= STILL * max(1, np.abs(values).max()):
            return
        extension = self.glb.uses("KHR_animation_pointer")
        self.track({"path": "pointer", "extensions": {extension: {"pointer": pointer}}}, values, jumps)

    def node(self, thing, more):
        """A node with its path, and when it is there."""
        there = [matrix is not None for matrix in thing.matrices]
        nearest = [min((abs(at - k), k) for k in range(len(there)) if there[k])[1] for at in range(len(there))]
        matrices = np.array([thing.matrices[k] for k in nearest])
        node = {"name": thing.name} | more
        place = self.glb.add("nodes", node)
        if np.ptp(matrices, axis=0).max() <= STILL:
            node["matrix"] = matrices[0].T.ravel().tolist()
        else:
            self.path(node, place, matrices)
        if not all(there):
            extension = self.glb.uses("KHR_node_visibility")
            node["extensions"] = node.get("extensions", {}) | {extension: {"visible": there[0]}}
            self.point(f"/nodes/{place}/extensions/{extension}/visible", np.array(there, np.uint8), True)
        return place, nearest

    def path(self, node, place, matrices):
        """Translation, rotation and scale of a node that moves."""
        from mathutils import Matrix

        parts = [Matrix(m).decompose() for m in matrices]
        rebuilt = [np.array(Matrix.LocRotScale(*part)) for part in parts]
        if np.abs(rebuilt - matrices).max() > 1e-4 * max(1, np.abs(matrices).max()):
            self.stage.notes.add(f"{node['name']}: it shears as it moves, which is left out")
        turns = np.array([[q.x, q.y, q.z, q.w] for _, q, _ in parts])
        for k in range(1, len(turns)):
            turns[k] *= 1 if turns[k] @ turns[k - 1] >= 0 else -1
        for name, values in (("translation", [p[0] for p in parts]), ("rotation", turns), ("scale", [p[2] for p in parts])):
            values = np.array(values)
            node[name] = values[0].tolist()
            if np.ptp(values, axis=0).max() > STILL:
                self.track({"node": place, "path": name}, values)

    def thing(self, thing):
        shapes = [shape for shape in thing.shapes if shape is not None]
        distinct = list({shape.digest: shape for shape in shapes}.values())
        if sum(shape.position.size for shape in distinct) > MOST_MORPHED:
            self.stage.notes.add(f"{thing.name}: it deforms with too many vertices for its frames, and stands as in the first")
            distinct = distinct[:1]
        mesh = self.mesh(thing, distinct)
        place, nearest = self.node(thing, {"mesh": mesh})
        self.objects[place] = thing.pass_index
        self.triangles += len(distinct[0].slots)
        if len(distinct) > 1:
            order = {shape.digest: k for k, shape in enumerate(distinct)}
            weights = np.zeros((len(nearest), len(distinct) - 1), np.float32)
            for at, k in enumerate(nearest):
                number = order[thing.shapes[k].digest]
                if number:
                    weights[at, number - 1] = 1
            self.track({"node": place, "path": "weights"}, weights.ravel())
        return place

    def mesh(self, thing, shapes):
        """The mesh of some shapes: the first, and the others as targets."""
        key = tuple(shape.digest for shape in shapes) + thing.materials
        if key in self.meshes:
            return self.meshes[key]
        base, glb = shapes[0], self.glb
        attributes = {"POSITION": glb.numbers(base.position, bounds=True), "NORMAL": glb.numbers(base.normal)}
        if base.uv.shape[1]:
            attributes["TEXCOORD_0"] = glb.numbers((base.uv * [1, -1] + [0, 1]).astype(np.float32))
        if base.colours.shape[1]:
            attributes["COLOR_0"] = glb.numbers(np.clip(base.colours, 0, 1))
        targets = []
        for shape in shapes[1:]:
            moved = glb.numbers(shape.position - base.position, bounds=True)
            targets.append({"POSITION": moved, "NORMAL": glb.numbers(shape.normal - base.normal)})
        primitives = []
        for slot in np.unique(base.slots):
            indices = base.indices.reshape(-1, 3)[base.slots == slot].ravel()
            primitive = {"attributes": attributes, "indices": glb.numbers(indices), "material": self.places[thing.materials[slot]]}
            primitives.append(primitive | ({"targets": targets} if targets else {}))
        self.meshes[key] = glb.add("meshes", {"name": thing.name, "primitives": primitives})
        return self.meshes[key]

    def paint(self, name, paint):
        """A material and the tracks of its colours."""
        surface, first = paint.now, next(v for v in paint.values if v is not None)
        values = [v or first for v in paint.values]
        pbr = {"baseColorFactor": values[0]["base"].tolist(), "metallicFactor": float(np.clip(surface.metallic, 0, 1))}
        pbr["roughnessFactor"] = float(np.clip(surface.roughness, 0, 1))
        material = {"name": name, "pbrMetallicRoughness": pbr, "doubleSided": not paint.culls, "extensions": {}}
        if surface.base.image:
            pbr["baseColorTexture"] = self.texture(surface.base.image)
        if surface.normal:
            material["normalTexture"] = self.texture(surface.normal[0]) | {"scale": surface.normal[1]}
        if surface.emission.image:
            material["emissiveTexture"] = self.texture(surface.emission.image)
        if min(v["base"][3] for v in values) < 1:
            material["alphaMode"] = "BLEND"
        if surface.transmission > 0:
            extension = self.glb.uses("KHR_materials_transmission")
            material["extensions"][extension] = {"transmissionFactor": min(surface.transmission, 1.0)}
        if surface.ior != 1.5:
            material["extensions"][self.glb.uses("KHR_materials_ior")] = {"ior": surface.ior}
        if surface.coat[0] > 0:
            coat = dict(zip(("clearcoatFactor", "clearcoatRoughnessFactor"), np.clip(surface.coat, 0, 1).tolist()))
            material["extensions"][self.glb.uses("KHR_materials_clearcoat")] = coat
        place = self.glb.add("materials", material)
        self.glow(place, material, np.array([v["glow"] for v in values]))
        self.point(f"/materials/{place}/pbrMetallicRoughness/baseColorFactor", [v["base"] for v in values])
        return place

    def glow(self, place, material, radiance):
        """Emission: a colour of at most 1 and its strength."""
        strength = radiance.max()
        if strength <= 0:
            return
        extension = self.glb.uses("KHR_materials_emissive_strength")
        material["emissiveFactor"] = (radiance[0] / strength).tolist()
        material["extensions"][extension] = {"emissiveStrength": float(strength)}
        self.point(f"/materials/{place}/emissiveFactor", radiance / strength)

    def texture(self, node):
        """The texture of an image node, with its mapping."""
        image = node.image
        if image.name_full not in self.images:
            data, kind = encoded(image)
            where = self.glb.add("images", {"bufferView": self.glb.bytes(data), "mimeType": kind, "name": image.name})
            self.images[image.name_full] = self.glb.add("textures", {"source": where})
        info = {"index": self.images[image.name_full]}
        mapping = source(node.inputs["Vector"])
        if mapping is not None and mapping.type == "MAPPING":
            turn = mapping.inputs["Rotation"].default_value[2]
            (x, y), (across, up) = (mapping.inputs[name].default_value[:2] for name in ("Location", "Scale"))
            offset = [x - up * math.sin(turn), 1 - y - up * math.cos(turn)]
            extension = self.glb.uses("KHR_texture_transform")
            info["extensions"] = {extension: {"offset": offset, "rotation": turn, "scale": [across, up]}}
        elif mapping is not None and mapping.type not in {"TEX_COORD", "UVMAP"}:
            self.stage.notes.add(f"{image.name}: {mapping.bl_label} at its coordinates is left out")
        return info

    def lamp(self, lamp):
        first = next(v for v in lamp.values if v is not None)
        values = [v or first for v in lamp.values]
        if lamp.light.startswith("AREA"):
            return self.area(lamp, values)
        extension = self.glb.uses("KHR_lights_punctual")
        kind = {"POINT": "point", "SPOT": "spot", "SUN": "directional"}[lamp.light]
        width = "sweeplight_angle" if lamp.light == "SUN" else "sweeplight_radius"
        light = {"name": lamp.name, "type": kind, "color": values[0]["colour"].tolist(), "intensity": values[0]["power"]}
        light["extras"] = {width: values[0]["spread"]}
        lights = self.glb.json.setdefault("extensions", {}).setdefault(extension, {"lights": []})["lights"]
        pointer = f"/extensions/{extension}/lights/{len(lights)}"
        lights.append(light)
        self.point(f"{pointer}/color", [v["colour"] for v in values])
        self.point(f"{pointer}/intensity", [v["power"] for v in values])
        if lamp.light == "SPOT":
            light["spot"] = {"innerConeAngle": values[0]["inner"], "outerConeAngle": values[0]["outer"]}
            self.point(f"{pointer}/spot/innerConeAngle", [v["inner"] for v in values])
            self.point(f"{pointer}/spot/outerConeAngle", [v["outer"] for v in values])
        if np.ptp([v["spread"] for v in values]) > STILL:
            self.stage.notes.add(f"{lamp.name}: its width stays as in the first frame")
        return self.node(lamp, {"extensions": {extension: {"light": len(lights) - 1}}})[0]

    def area(self, lamp, values):
        """An area light: a rectangle or disk of side 1 that nobody sees, scaled by its node; it shines along −z."""
        if lamp.light == "AREA":
            rim = np.array([(-1, -1), (-1, 1), (1, 1), (1, -1)]) / 2
        else:
            angle = -2 * math.pi * np.arange(DISK_EDGES) / DISK_EDGES
            # As large as the disk: the polygon's corners lie a little outside.
            radius = math.sqrt(math.pi / 4 / (DISK_EDGES / 2 * math.sin(2 * math.pi / DISK_EDGES)))
            rim = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        corners = np.concatenate([rim, np.zeros((len(rim), 1))], axis=1).astype(np.float32)
        fan = np.array([(0, k, k + 1) for k in range(1, len(rim) - 1)], np.uint32).ravel()
        pbr = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}
        material = {"name": lamp.name, "pbrMetallicRoughness": pbr, "extensions": {}, "extras": {"sweeplight_unseen": True}}
        place = self.glb.add("materials", material)
        self.glow(place, material, np.array([v["colour"] * v["power"] for v in values]))
        attributes = {"POSITION": self.glb.numbers(corners, bounds=True)}
        primitive = {"attributes": attributes, "indices": self.glb.numbers(fan), "material": place}
        return self.node(lamp, {"mesh": self.glb.add("meshes", {"name": lamp.name, "primitives": [primitive]})})[0]

    def look(self):
        """The camera."""
        camera, values = self.stage.camera, self.stage.camera.values
        kind, lens = camera.light, [v["lens"] for v in values]
        # What lies beyond does not concern sweeplight; glTF asks for it.
        ends = {"znear": 0.01, "zfar": 1000.0}
        flat = {"xmag": lens[0] * self.stage.size[0] / self.stage.size[1], "ymag": lens[0]}
        shown = flat | ends if kind == "orthographic" else {"yfov": lens[0]} | ends
        shifts = np.array([v["shift"] for v in values])
        if np.ptp(shifts, axis=0).max() > STILL:
            self.stage.notes.add("Camera: its shift stays as in the first frame")
        extras = {"extras": {"sweeplight_shift": shifts[0].tolist()}} if np.abs(shifts[0]).max() > 0 else {}
        place = self.glb.add("cameras", {"name": "Camera", "type": kind, kind: shown} | extras)
        self.point(f"/cameras/{place}/{kind}/" + ("ymag" if kind == "orthographic" else "yfov"), lens)
        return self.node(camera, {"camera": place})[0]

    def focused(self):
        """A node at the point in focus."""
        if None in self.stage.focus:
            return []
        spot = Thing("Focus", len(self.times))
        for at, (distance, _) in enumerate(self.stage.focus):
            ahead = np.eye(4)
            ahead[2, 3] = -distance
            spot.matrices[at] = TURNED @ self.stage.camera.matrices[at] @ ahead
        return [self.node(spot, {})[0]]


# From z up to y up.
TURNED = np.array([(1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)], float)


def encoded(image):
    """An image's bytes as glTF takes them: its own file where that is PNG or JPEG, else a new PNG."""
    data = b""
    if not image.is_dirty and image.source == "FILE":
        path = bpy.path.abspath(image.filepath, library=image.library)
        if image.packed_file:
            data = image.packed_file.data
        elif os.path.isfile(path):
            with open(path, "rb") as file:
                data = file.read()
    for sign, kind in ((b"\x89PNG", "image/png"), (b"\xff\xd8\xff", "image/jpeg")):
        if data.startswith(sign):
            return data, kind
    if not image.has_data and not image.size[0]:
        raise Trouble(f"{image.name}: the image cannot be read — find it under File, External Data, Find Missing Files")
    return png(image), "image/png"
