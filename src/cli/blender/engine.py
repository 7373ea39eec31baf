# The render engine.


class SweeplightEngine(bpy.types.RenderEngine):
    bl_idname = "SWEEPLIGHT"
    bl_label = "sweeplight"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    def update_render_passes(self, scene, view_layer):
        self.register_pass(scene, view_layer, "Combined", 4, "RGBA", "COLOR")
        for p in passes_of(view_layer):
            self.register_pass(scene, view_layer, p.name, len(p.channels), p.channels, p.kind)

    def render(self, depsgraph):
        scene, layer = depsgraph.scene, depsgraph.view_layer
        key = scene.name_full, layer.name
        try:
            if key not in JOBS or scene.frame_current not in JOBS[key].left:
                if key in JOBS:
                    JOBS.pop(key).close()
                JOBS[key] = Job(self, depsgraph)
            channels = JOBS[key].frame(self, scene.frame_current)
            self.hand_over(scene, layer, channels, JOBS[key].objects)
            if not JOBS[key].left:
                JOBS.pop(key).close()
        except Cancelled:
            self.give_up(scene)
        except Trouble as trouble:
            self.give_up(scene)
            self.report({"ERROR"}, str(trouble))
        except Exception as fault:
            traceback.print_exc()
            self.give_up(scene)
            self.report({"ERROR"}, f"the add-on failed: {fault} — the console says where")

    def give_up(self, scene):
        """Ends all processes; Blender crashes where a render leaves no picture at all."""
        close_jobs()
        self.end_result(self.begin_result(0, 0, *size_of(scene)))

    def hand_over(self, scene, layer, channels, objects):
        """Gives Blender the picture and its passes, cut to the border where there is one."""
        render, (width, height) = scene.render, size_of(scene)
        x0, y0, x1, y1 = 0, 0, width, height
        if render.use_border:
            x0, x1 = int(render.border_min_x * width), int(render.border_max_x * width)
            y0, y1 = int(render.border_min_y * height), int(render.border_max_y * height)
        wanted = passes_of(layer)
        for p in wanted:
            self.add_pass(p.name, len(p.channels), p.channels, layer=layer.name)
        picture = rgb(channels, "")
        pictures = {"Combined": np.concatenate([picture, np.ones_like(picture[..., :1])], axis=2)}
        pictures.update((p.name, p.picture(channels, objects)) for p in wanted)
        result = self.begin_result(0, 0, x1 - x0, y1 - y0, layer=layer.name)
        for name, values in pictures.items():
            # Blender's first row is the lowest.
            values = np.ascontiguousarray(values[::-1][y0:y1, x0:x1], np.float32)
            result.layers[0].passes[name].rect.foreach_set(values.ravel())
        self.end_result(result)
