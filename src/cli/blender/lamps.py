# Lamps, and the point in focus.


def focus(eye, lens, depsgraph, focal):
    """Distance in focus, and the stop at which a lens for film 24 mm high, `focal` mm long, is as wide as Blender's."""
    distance = lens.dof.focus_distance
    if lens.dof.focus_object:
        target = lens.dof.focus_object.evaluated_get(depsgraph).matrix_world.translation
        distance = -(eye.matrix_world.normalized().inverted() @ target).z
    return distance, lens.dof.aperture_fstop * focal / lens.lens


def area_size(light):
    """Width and height of an area light in its own metres, at least a millimetre."""
    up = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    return max(light.size, 1e-3), max(up, 1e-3)


def shine(light, matrix):
    """Colour, strength, and cone of a lamp: W/sr, W/m² of a sun, radiance of an area light."""
    colour = np.array(light.color, float)
    if getattr(light, "use_temperature", False):
        colour = colour * np.array(light.temperature_color)
    power = light.energy * 2.0 ** getattr(light, "exposure", 0.0)
    whole = getattr(light, "normalize", True)
    shine = {"spread": 0.0}
    if light.type == "AREA":
        across, up = area_size(light)
        area = np.linalg.norm(np.cross(matrix[:3, 0] * across, matrix[:3, 1] * up))
        area *= math.pi / 4 if light.shape in {"DISK", "ELLIPSE"} else 1.0
        power /= math.pi * (max(area, 1e-9) if whole else 1.0)
    elif light.type == "SUN":
        shine["spread"] = min(light.angle, math.pi / 2)
        power *= 1.0 if whole else math.pi * math.sin(light.angle / 2) ** 2
    else:
        shine["spread"] = radius = light.shadow_soft_size
        power *= 1 / (4 * math.pi) if whole else radius**2
    if light.type == "SPOT":
        # The cone's edge is a cubic in Blender and a square in glTF: over three quarters of the way both take the same light.
        edge = math.cos(light.spot_size / 2)
        inner = math.acos(min(1.0, edge + 0.75 * (1 - edge) * light.spot_blend))
        shine["outer"] = min(light.spot_size / 2, math.pi / 2)
        shine["inner"] = min(inner, shine["outer"])
    brightest = max(colour.max(), 1e-9)
    return shine | {"colour": colour / brightest, "power": max(power, 0.0) * brightest}


def note_lamp(thing, notes):
    light = thing.data
    if light.type == "AREA" and light.spread < math.pi - 1e-3:
        notes.add(f"{thing.name}: its spread is left out, it shines to all sides with the same power")
    if light.use_nodes and light.node_tree and any(n.type not in {"EMISSION", "OUTPUT_LIGHT"} for n in light.node_tree.nodes):
        notes.add(f"{thing.name}: its nodes are left out")
    if not getattr(light, "use_soft_falloff", True):
        notes.add(f"{thing.name}: its falloff is soft all the same")
    if thing.visible_camera:
        notes.add(f"{thing.name}: the camera does not see it")
    if not light.use_shadow:
        notes.add(f"{thing.name}: it casts shadows all the same")
