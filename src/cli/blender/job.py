# The run: one process for all frames of a render.


class Told:
    """What the panel shows of the last render."""

    rows = []
    total = ""
    verified = ""
    lost = []


def program():
    """The path of the sweeplight program."""
    addon = bpy.context.preferences.addons.get(__name__)
    chosen = bpy.path.abspath(addon.preferences.binary) if addon and addon.preferences.binary else ""
    found = chosen or (BINARY if os.path.isfile(BINARY) else shutil.which("sweeplight"))
    if not found or not os.path.isfile(found):
        raise Trouble(f"no program at '{found or BINARY}' — set its path under Preferences, Add-ons, sweeplight")
    return found


def frame_lists(scene, whole):
    """The frames to render, and those to sample for them."""
    render = scene.render
    if not whole:
        wanted = [scene.frame_current]
    else:
        wanted = list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step))
        if not (render.use_overwrite or render.is_movie_format):
            wanted = [f for f in wanted if not os.path.exists(render.frame_path(frame=f))] or wanted
    if not render.use_motion_blur:
        return wanted, wanted
    # An open shutter looks at the times around each frame.
    return wanted, list(range(wanted[0] - 1, wanted[-1] + 2))


def size_of(scene):
    render = scene.render
    share = render.resolution_percentage / 100
    return max(int(render.resolution_x * share), 1), max(int(render.resolution_y * share), 1)


def sample(engine, depsgraph, frames):
    """The stage at these frames."""
    scene = depsgraph.scene
    now, part = scene.frame_current, scene.frame_subframe
    stage = Stage(scene, depsgraph, frames, size_of(scene))
    for at, frame in enumerate(frames):
        if engine.test_break():
            raise Cancelled
        if len(frames) > 1:
            engine.update_stats("", f"sweeplight: frame {frame} of the scene")
            engine.frame_set(frame, part if len(frames) == 3 and frames[1] == now else 0.0)
        camera = engine.camera_override or scene.camera
        if camera is None:
            raise Trouble("the scene has no camera — add one, and make it the active camera")
        stage.take(at, camera)
    if len(frames) > 1:
        engine.frame_set(now, part)
    note_scene(scene, stage.notes)
    return stage


def note_scene(scene, notes):
    render = scene.render
    if render.pixel_aspect_x != render.pixel_aspect_y:
        notes.add("Scene: pixels are rendered square")
    if render.film_transparent:
        notes.add("Scene: the film is not transparent")
    if render.use_freestyle:
        notes.add("Scene: Freestyle's lines are left out")


class Job:
    """One process for all frames of a render."""

    def __init__(self, engine, depsgraph):
        scene = depsgraph.scene
        self.engine, self.settings = engine, scene.sweeplight
        kept = bpy.path.abspath(self.settings.keep) if self.settings.keep else ""
        if kept and len(scene.view_layers) > 1:
            kept = os.path.join(kept, bpy.path.clean_name(depsgraph.view_layer.name))
        self.kept, self.process, self.failure = bool(kept), None, ""
        self.lines, self.wait, self.told = queue.Queue(), True, ""
        try:
            if kept:
                os.makedirs(kept, exist_ok=True)
            self.folder = kept or tempfile.mkdtemp(prefix="sweeplight_")
            self.start(engine, depsgraph)
        except OSError as error:
            self.close()
            raise Trouble(f"{error.filename or kept}: {error.strerror} — name another folder") from error
        except BaseException:
            self.close()
            raise

    def start(self, engine, depsgraph):
        """Writes the scene and starts the process on it."""
        # Frames of an earlier render would pass for those of this one.
        for name in os.listdir(self.folder):
            if re.fullmatch(r"frame_\d+\.exr|report\.json", name):
                os.remove(os.path.join(self.folder, name))
        scene = depsgraph.scene
        wanted, sampled = frame_lists(scene, engine.is_animation)
        self.left, self.first = set(wanted), sampled[0]
        stage = sample(engine, depsgraph, sampled)
        world = sky(scene.world, depsgraph, self.folder, stage.notes)
        render = scene.render
        fps = render.fps / render.fps_base
        writer = Writer(stage, fps)
        writer.write(os.path.join(self.folder, "scene.glb"))
        self.objects = writer.objects
        frames = ",".join(str(frame - self.first) for frame in wanted)
        common = ["scene.glb", "--camera", "0", "--fps", f"{fps:.9g}", "--frames", frames, "--light-units", "gltf"]
        common += [f"--sky={world if ',' in world else os.path.basename(world)}"] + effort(scene, writer.triangles) + lens_flags(render, stage)
        self.common = [program()], common
        picture = ["--size", "%dx%d" % stage.size, "--pixel-samples", str(self.settings.pixel_samples)]
        layers = {layer for p in passes_of(depsgraph.view_layer) for layer in p.layers}
        picture += ["--aov", ",".join(sorted(layers))] if layers else []
        picture += ["--exr-float", "-o", "frame_####.exr", "--report", "report.json"]
        Told.rows, Told.total, Told.verified, Told.lost = [], "", "", sorted(stage.notes)
        self.run("render", common + picture)

    def run(self, command, arguments):
        """Starts a process, and a thread that hears what it says."""
        line = self.common[0] + [command] + arguments
        if self.kept:
            with open(os.path.join(self.folder, f"{command}.json"), "w", encoding="utf-8") as file:
                json.dump(line, file)
        hidden = {"creationflags": subprocess.CREATE_NO_WINDOW} if os.name == "nt" else {}
        pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        self.process = subprocess.Popen(line, cwd=self.folder, encoding="utf-8", errors="replace", **pipes, **hidden)
        self.wait = True

        def listen(process, lines):
            for text in process.stdout:
                lines.put(text.rstrip())
            lines.put(None)

        threading.Thread(target=listen, args=(self.process, self.lines), daemon=True).start()

    def hear(self, engine):
        """Takes in what the process has said so far."""
        while not self.lines.empty():
            line = self.lines.get()
            if line is None:
                self.wait = False
                continue
            if line.startswith("error: "):
                self.failure = line[7:]
            elif line.startswith("warning: "):
                Told.lost.append(line[9:])
            elif line.startswith("Fra:"):
                done, total = line[4:].split()[0].split("/")
                Told.rows.append(line)
                engine.update_progress(int(done) / int(total))
            elif line:
                self.told = line
            engine.update_stats("", f"sweeplight: {line}")

    def until(self, engine, there):
        """Waits until something is there, the process ends, or the user gives up."""
        while not there():
            if engine.test_break():
                raise Cancelled
            self.hear(engine)
            if not self.wait and not there():
                raise Trouble(self.failure or f"sweeplight ended with code {self.process.wait()}: {self.told}")
            time.sleep(PATIENCE)

    def frame(self, engine, frame):
        """The channels of a frame, as soon as it is done."""
        path = os.path.join(self.folder, f"frame_{frame - self.first:04d}.exr")
        self.until(engine, lambda: os.path.exists(path))
        channels = read_exr(path)
        if not self.kept:
            os.remove(path)
        self.left.discard(frame)
        if not self.left:
            self.finish(engine)
        return channels

    def finish(self, engine):
        """Reads the report, once the last frame is done, and verifies where that is asked for."""
        self.until(engine, lambda: not self.wait)
        self.hear(engine)
        path = os.path.join(self.folder, "report.json")
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                total = json.load(file)["total"]
            saving = total.get("saving")
            Told.total = f"{100 * saving:.1f} % of all samples were not tested again" if saving is not None else ""
        if self.settings.verify:
            self.run("verify", self.common[1])
            self.until(engine, lambda: not self.wait)
            self.hear(engine)
            Told.verified = self.failure or self.told
            if self.process.wait():
                raise Trouble(Told.verified)

    def close(self):
        """Ends the process and leaves nothing behind."""
        if self.process and self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        if not self.kept:
            shutil.rmtree(getattr(self, "folder", ""), ignore_errors=True)


# Elements of each quality, as `sweeplight render --help` has them.
ELEMENTS = {"DRAFT": 4000, "STANDARD": 16000, "FINE": 64000}


def effort(scene, triangles):
    """The flags of the panel, and of Blender's threads."""
    settings = scene.sweeplight
    # Each triangle makes an element: modifiers' many small ones must not use up those of walls and floors.
    elements = settings.elements or min(ELEMENTS[settings.quality] + triangles, 16777215)
    flags = ["--quality", settings.quality.lower(), "--finish", settings.finish.lower()]
    flags += ["--elements", str(elements), "--light-samples", str(settings.light_samples)]
    return flags + (["--threads", str(scene.render.threads)] if scene.render.threads_mode == "FIXED" else [])


def lens_flags(render, stage):
    """The flags of depth of field and of the shutter."""
    flags = []
    if None not in stage.focus:
        flags += ["--f-stop", f"{min(max(stage.focus[0][1], 0.01), 1000):.6g}", "--focus", "Focus"]
    if render.use_motion_blur:
        shutter = getattr(render, "motion_blur_shutter", 0.5)
        flags += ["--shutter", f"{min(max(shutter, 0), 1):.6g}"]
    return flags


# Jobs by scene and view layer; a failure stays until the next render, so that no frame starts anew in vain.
JOBS = {}


@persistent
def close_jobs(*_):
    while JOBS:
        JOBS.popitem()[1].close()
