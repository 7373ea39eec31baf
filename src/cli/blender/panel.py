# Settings and panels.


class SweeplightSettings(bpy.types.PropertyGroup):
    quality: bpy.props.EnumProperty(
        name="Quality",
        items=[
            ("DRAFT", "Draft", "A quick look: about 4,000 elements, 128 samples"),
            ("STANDARD", "Standard", "About 16,000 elements, 256 samples"),
            ("FINE", "Fine", "For the last render: about 64,000 elements, 512 samples"),
        ],
        default="STANDARD",
    )
    finish: bpy.props.EnumProperty(
        name="Finish",
        description="Indirect light in pixels",
        items=[
            ("INTERPOLATE", "Interpolate", "Interpolated between elements; the fastest"),
            ("HYBRID", "Hybrid", "Final gather near contacts and on movers, interpolated elsewhere"),
            ("GATHER", "Gather", "Final gather in every pixel"),
        ],
        default="HYBRID",
    )
    elements: bpy.props.IntProperty(name="Elements", description="Largest number of elements; 0: by quality, and one more for each triangle", min=0, max=16777215)
    light_samples: bpy.props.IntProperty(
        name="Light Samples", description="Samples of a receiver to each emitter; more smooth penumbrae", min=1, max=1024, default=16
    )
    pixel_samples: bpy.props.EnumProperty(
        name="Pixel Samples", items=[(str(n * n), str(n * n), "Edges take 8 times as many") for n in range(1, 9)], default="4"
    )
    verify: bpy.props.BoolProperty(
        name="Verify", description="Afterwards compare every frame with a trace and a solve from nothing, which takes long"
    )
    keep: bpy.props.StringProperty(
        name="Keep Files In", description="Folder in which scene, frames and report stay; empty: none stays", subtype="DIR_PATH"
    )


class SweeplightPreferences(bpy.types.AddonPreferences):
    bl_idname = __name__
    binary: bpy.props.StringProperty(
        name="Program", description="The sweeplight program; empty: the one that wrote this file, or the one in PATH", subtype="FILE_PATH"
    )

    def draw(self, _):
        self.layout.prop(self, "binary")


class SweeplightPanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"

    @classmethod
    def poll(cls, context):
        return context.engine == SweeplightEngine.bl_idname


class RENDER_PT_sweeplight(SweeplightPanel, bpy.types.Panel):
    bl_label = "Light"

    def draw(self, context):
        self.layout.use_property_split = True
        for name in ("quality", "finish", "elements", "light_samples", "pixel_samples", "verify", "keep"):
            self.layout.prop(context.scene.sweeplight, name)
        render = context.scene.render
        self.layout.prop(render, "use_motion_blur")
        if render.use_motion_blur:
            self.layout.prop(render, "motion_blur_shutter")


class RENDER_PT_sweeplight_saved(SweeplightPanel, bpy.types.Panel):
    bl_label = "Saved by Reuse"

    def draw(self, _):
        for text in (Told.total, Told.verified):
            if text:
                self.layout.label(text=text)
        column = self.layout.column(align=True)
        for row in Told.rows[-24:] or ["Rendered frames appear here"]:
            column.label(text=row)


class RENDER_PT_sweeplight_lost(SweeplightPanel, bpy.types.Panel):
    bl_label = "What Does Not Come Over"

    def draw(self, _):
        self.layout.operator(SweeplightCheck.bl_idname)
        column = self.layout.column(align=True)
        for text in Told.lost:
            column.label(text=text, icon="INFO")


class VIEWLAYER_PT_sweeplight_passes(SweeplightPanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context):
        self.layout.use_property_split = True
        for switch in dict.fromkeys(row[4] for row in PASSES):
            self.layout.prop(context.view_layer, switch)


class SweeplightCheck(bpy.types.Operator):
    """List what of the scene does not come over, as it is in this frame"""

    bl_idname = "render.sweeplight_check"
    bl_label = "Look Through the Scene"

    def execute(self, context):
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        stage = Stage(scene, depsgraph, [scene.frame_current], size_of(scene))
        with tempfile.TemporaryDirectory(prefix="sweeplight_") as folder:
            try:
                if scene.camera is None:
                    raise Trouble("the scene has no camera — add one, and make it the active camera")
                stage.take(0, scene.camera)
                sky(scene.world, depsgraph, folder, stage.notes)
                Writer(stage, scene.render.fps).write(os.path.join(folder, "scene.glb"))
            except Trouble as trouble:
                self.report({"ERROR"}, str(trouble))
                return {"CANCELLED"}
        note_scene(scene, stage.notes)
        Told.lost = sorted(stage.notes) or ["Everything comes over"]
        return {"FINISHED"}


CLASSES = [
    SweeplightEngine,
    SweeplightSettings,
    SweeplightPreferences,
    SweeplightCheck,
    RENDER_PT_sweeplight,
    RENDER_PT_sweeplight_saved,
    RENDER_PT_sweeplight_lost,
    VIEWLAYER_PT_sweeplight_passes,
]

# Panels of Blender's that are of use although they do not say so.
BORROWED = {
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "DATA_PT_EEVEE_light",
    "DATA_PT_spot",
}


def panels():
    """Blender's own panels that suit any engine."""
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if engines is not None and ("BLENDER_RENDER" in engines or panel.__name__ in BORROWED):
            yield engines


def register():
    for item in CLASSES:
        bpy.utils.register_class(item)
    bpy.types.Scene.sweeplight = bpy.props.PointerProperty(type=SweeplightSettings)
    bpy.types.ViewLayer.sweeplight_denoising_data = bpy.props.BoolProperty(
        name="Denoising Data", description="Albedo, normal and depth for a denoiser"
    )
    for engines in panels():
        engines.add(SweeplightEngine.bl_idname)
    for handlers in (bpy.app.handlers.render_init, bpy.app.handlers.render_complete, bpy.app.handlers.render_cancel):
        handlers.append(close_jobs)
    atexit.register(close_jobs)


def unregister():
    close_jobs()
    atexit.unregister(close_jobs)
    for handlers in (bpy.app.handlers.render_init, bpy.app.handlers.render_complete, bpy.app.handlers.render_cancel):
        handlers.remove(close_jobs)
    for engines in panels():
        engines.discard(SweeplightEngine.bl_idname)
    del bpy.types.ViewLayer.sweeplight_denoising_data
    del bpy.types.Scene.sweeplight
    for item in reversed(CLASSES):
        bpy.utils.unregister_class(item)
