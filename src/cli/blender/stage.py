# The scene, sampled: every object, lamp and camera in each frame, as Blender evaluates them.

MESHY = {"MESH", "CURVE", "SURFACE", "META", "FONT"}
LEFT_OUT = {"CURVES": "hair", "POINTCLOUD": "a point cloud", "VOLUME": "a volume", "GREASEPENCIL": "a drawing"}


class Shape:
    """The triangles of a mesh at one time: corners that are alike are one vertex."""

    def __init__(self, mesh, colour, known):
        mesh.calc_loop_triangles()
        triangles, corners = mesh.loop_triangles, len(mesh.loops)
        loops = read(triangles, "loops", np.int32, 3 * len(triangles))
        vertex = read(mesh.loops, "vertex_index", np.int32, corners)
        self.slots = read(triangles, "material_index", np.int32, len(triangles))
        normal = read(mesh.corner_normals, "vector", np.float32, 3 * corners).reshape(-1, 3)
        layer = next((l for l in mesh.uv_layers if l.active_render), None)
        self.uv = read(layer.uv, "vector", np.float32, 2 * corners).reshape(-1, 2) if layer else np.empty((corners, 0), np.float32)
        self.colours = colours_of(mesh, colour, vertex)
        digest = blake2b(b"".join(a.tobytes() for a in (loops, vertex, self.slots, self.uv, self.colours))).digest()
        # Which corners are one was decided when this object was first seen: its shapes must agree on it.
        if digest not in known:
            rows = np.concatenate([vertex[:, None].view(np.float32), normal, self.uv, self.colours], axis=1)
            rows = np.ascontiguousarray(rows).view([("", f"V{4 * rows.shape[1]}")]).ravel()
            _, first, where = np.unique(rows, return_index=True, return_inverse=True)
            known[digest] = first, where.ravel()[loops].astype(np.uint32)
        first, self.indices = known[digest]
        self.topology = digest
        self.uv, self.colours = self.uv[first], self.colours[first]
        self.position = read(mesh.vertices, "co", np.float32, 3 * len(mesh.vertices)).reshape(-1, 3)[vertex[first]]
        self.normal = normal[first]
        self.digest = blake2b(self.position.tobytes() + self.normal.tobytes() + digest).digest()


def read(items, field, kind, count):
    values = np.empty(count, kind)
    items.foreach_get(field, values)
    return values


def colours_of(mesh, name, vertex):
    """A colour attribute at each corner, linear; nothing where there is none."""
    layer = mesh.color_attributes.get(name) if name else None
    if layer is None or layer.domain not in {"POINT", "CORNER"}:
        return np.empty((len(vertex), 0), np.float32)
    values = read(layer.data, "color", np.float32, 4 * len(layer.data)).reshape(-1, 4)
    return values[vertex] if layer.domain == "POINT" else values


class Thing:
    """A node to be: where it is in each sampled frame, and what it shows there."""

    def __init__(self, name, frames):
        self.name = name
        self.matrices = [None] * frames
        self.shapes = [None] * frames
        self.values = [None] * frames
        self.materials = ()
        self.pass_index = 0
        self.light = None


class Stage:
    """Everything that comes over, frame by frame."""

    def __init__(self, scene, depsgraph, frames, size):
        self.scene = scene
        self.depsgraph = depsgraph
        self.frames = frames
        self.size = size
        self.things = {}
        self.lamps = {}
        self.materials = {}
        self.camera = Thing("Camera", len(frames))
        self.focus = [None] * len(frames)
        self.notes = set()
        self.known = {}
        self.resting = {}

    def take(self, at, camera):
        """Takes in what Blender shows now, as the sampled frame `at`."""
        shapes = {}
        for instance in self.depsgraph.object_instances:
            thing = instance.object
            if thing.type in MESHY and instance.show_self:
                self.mesh(at, instance, shapes)
            elif thing.type == "LIGHT" and instance.show_self:
                self.lamp(at, instance)
            elif thing.type in LEFT_OUT:
                self.notes.add(f"{thing.name}: {LEFT_OUT[thing.type]} is left out")
        for material in self.materials.values():
            material.take(at, self.depsgraph, self.notes)
        self.look(at, camera)

    def mesh(self, at, instance, shapes):
        thing = instance.object
        shape = self.shape(instance, shapes)
        if shape is None:
            return
        key = name_of(instance) + (shape.topology,)
        node = self.things.get(key)
        if node is None:
            node = self.things[key] = Thing(thing.name, len(self.frames))
            node.pass_index = thing.pass_index
            node.materials = tuple(self.material(at, thing, slot) for slot in range(shape.slots.max() + 1))
            self.look_over(thing)
        node.matrices[at], node.shapes[at] = np.array(instance.matrix_world), shape

    def look_over(self, thing):
        """Notes what of an object does not come over."""
        if not thing.visible_camera or not thing.visible_diffuse or not thing.visible_shadow:
            self.notes.add(f"{thing.name}: its ray visibility is left out, all rays see it")
        if thing.is_holdout or thing.is_shadow_catcher:
            self.notes.add(f"{thing.name}: it is rendered as any object, no holdout or shadow catcher")
        if any(system.settings.type == "HAIR" and system.settings.render_type == "PATH" for system in thing.particle_systems):
            self.notes.add(f"{thing.name}: its hair is left out")

    def shape(self, instance, shapes):
        """The shape of an instance now; what cannot change is read once."""
        thing = instance.object
        original = thing.original
        rests = thing.type == "MESH" and not instance.is_instance and not original.modifiers
        rests = rests and not original.data.shape_keys and not original.data.animation_data and original.mode != "EDIT"
        if rests and original.data in self.resting:
            return self.resting[original.data]
        key = thing.data.as_pointer() if thing.data else 0
        if key not in shapes:
            mesh = thing.data if isinstance(thing.data, bpy.types.Mesh) else thing.to_mesh()
            whole = mesh is not None and len(mesh.polygons) > 0
            known = self.known.setdefault(thing.name_full, {})
            shapes[key] = Shape(mesh, self.painted(thing), known) if whole else None
            if mesh is not thing.data:
                thing.to_mesh_clear()
        if rests:
            self.resting[original.data] = shapes[key]
        return shapes[key]

    def painted(self, thing):
        """The colour attribute that an object's materials ask for."""
        names = (self.materials[self.material(0, thing, slot)].now.base.attribute for slot in range(len(thing.material_slots)))
        return next((name for name in names if name), None)

    def material(self, at, thing, slot):
        """The key of the material in a slot."""
        slots = thing.material_slots
        material = slots[min(slot, len(slots) - 1)].material if len(slots) else None
        key = material.original.name_full if material else ""
        if key not in self.materials:
            self.materials[key] = Paint(material, len(self.frames))
            self.materials[key].take(at, self.depsgraph, self.notes)
        return key

    def lamp(self, at, instance):
        thing, light = instance.object, instance.object.data
        if not thing.visible_diffuse:
            return
        key = name_of(instance)
        node = self.lamps.get(key)
        if node is None:
            node = self.lamps[key] = Thing(thing.name, len(self.frames))
            note_lamp(thing, self.notes)
        node.light = light.type
        matrix = np.array(instance.matrix_world)
        node.matrices[at], node.values[at] = matrix, shine(light, matrix)
        if light.type == "AREA":
            across, up = area_size(light)
            node.matrices[at] = matrix @ np.diag([across, up, 1, 1])
            node.light += "_DISK" if light.shape in {"DISK", "ELLIPSE"} else ""

    def look(self, at, camera):
        """The camera now: where it is, its angle, shift and focus."""
        eye = camera.evaluated_get(self.depsgraph)
        lens, render = eye.data, self.scene.render
        if lens.type == "PANO":
            raise Trouble("the camera is panoramic: expected a perspective or orthographic one — change its type under Lens")
        width, height = self.size
        p = np.array(eye.calc_matrix_camera(self.depsgraph, x=width, y=height, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y))
        flat = lens.type == "ORTHO"
        across = -p[0, 3] / p[0, 0] if flat else p[0, 2] / p[0, 0]
        shift = [across * p[1, 1] / 2, (-p[1, 3] if flat else p[1, 2]) / 2]
        self.camera.matrices[at] = np.array(eye.matrix_world.normalized())
        self.camera.values[at] = {"lens": 1 / p[1, 1] if flat else 2 * math.atan(1 / p[1, 1]), "shift": shift}
        self.camera.light = "orthographic" if flat else "perspective"
        if lens.dof.use_dof and not flat:
            self.focus[at] = focus(eye, lens, self.depsgraph, 12 * p[1, 1])


def name_of(instance):
    """What an instance is called in every frame."""
    parent = instance.parent.name_full if instance.is_instance and instance.parent else ""
    return instance.object.name_full, parent, tuple(instance.persistent_id) if instance.is_instance else ()
