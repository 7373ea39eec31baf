# The world, as sweeplight's sky.


def sky(world, depsgraph, folder, notes):
    """The value of --sky for a world: a colour, or a picture that is written into the folder."""
    if world is None:
        return "0,0,0"
    notes.update(f"World: {text}" for text in ["its volume is left out"] if has_volume(world))
    evaluated = world.evaluated_get(depsgraph)
    tree = evaluated.node_tree if getattr(evaluated, "use_nodes", True) else None
    output = tree.get_output_node("CYCLES") if tree else None
    node = source(output.inputs["Surface"]) if output else None
    if node is None or node.type not in {"BACKGROUND", "EMISSION"}:
        if node is not None:
            notes.add(f"World: {node.bl_label} is left out, its colour stands")
        return ",".join(f"{c:.9g}" for c in (world.color if output is None else BLACK))
    reader = Reader(world, notes)
    strength, picture = max(reader.number(node.inputs["Strength"]), 0), source(node.inputs["Color"])
    if picture is not None and picture.type == "TEX_ENVIRONMENT" and picture.image and picture.projection == "EQUIRECTANGULAR":
        path = os.path.join(folder, "sky.hdr")
        write_hdr(path, strength * np.maximum(panorama(picture, notes), 0))
        return path
    return ",".join(f"{max(c, 0) * strength:.9g}" for c in reader.colour(node.inputs["Color"]).factor)


def has_volume(world):
    output = world.node_tree.get_output_node("CYCLES") if world.node_tree else None
    return bool(output and output.inputs["Volume"].is_linked)


def panorama(node, notes):
    """An environment's radiance as sweeplight places it, turned by its mapping."""
    pixels = pixels_of(node.image)[..., :3]
    if not node.image.is_float:
        pixels = np.where(pixels < 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4)
    mapping = source(node.inputs["Vector"])
    if mapping is None or mapping.type == "TEX_COORD":
        return pixels
    if mapping.type != "MAPPING":
        notes.add(f"World: {mapping.bl_label} at its coordinates is left out")
        return pixels
    from mathutils import Euler

    height, width = pixels.shape[:2]
    turn = np.array(Euler(mapping.inputs["Rotation"].default_value).to_matrix())
    azimuth = -((np.arange(width) + 0.5) / width - 0.5) * 2 * math.pi
    polar = (np.arange(height) + 0.5) / height * math.pi
    level = np.sin(polar)[:, None]
    towards = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.cos(polar)[:, None] + 0 * azimuth], axis=2)
    x, y, z = np.moveaxis((towards * np.array(mapping.inputs["Scale"].default_value)) @ turn.T, 2, 0)
    column = (0.5 - np.arctan2(y, x) / (2 * math.pi)) * width
    row = np.arctan2(np.hypot(x, y), z) / math.pi * height
    return pixels[np.clip(row.astype(int), 0, height - 1), column.astype(int) % width]
