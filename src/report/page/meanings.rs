//! What each figure of the report means, by its way through the JSON.
//!
//! Figures stand on the page in the order of these lists.

/// Figures of a frame, in the order of the columns.
pub(super) const FRAME: &[(&str, &str)] = &[
    ("frame", "The frame's number."),
    (
        "time",
        "The time of the animation that it shows, in seconds.",
    ),
    (
        "samples",
        "Questions that all form factors of the frame rest on.",
    ),
    ("candidates", "Of those, tested or traced again."),
    (
        "changed",
        "Of those, really different from the frame rendered before: the least to ask.",
    ),
    ("saving", "1 − candidates ÷ samples."),
    (
        "oracle_saving",
        "1 − changed ÷ samples: the most that any method could save.",
    ),
    (
        "tightness",
        "Changed ÷ candidates; 1 where nothing was asked in vain.",
    ),
    (
        "contested",
        "Hemisphere samples that some mover may ever touch.",
    ),
    (
        "pairs_changed",
        "Pairs of patches whose form factor changed.",
    ),
    (
        "pairs_near",
        "Pairs of patches whose factor is the contour integral times what samples see of it.",
    ),
    ("pixels", "Pixels of the image."),
    (
        "pixels_recomputed",
        "Pixels of which anything was asked again.",
    ),
    ("sweeps", "Passes of the solver over all rows."),
    (
        "shots",
        "Shots of a progressive solver; 0 where it gathers.",
    ),
    ("residual", "What the solver left, relative to the light."),
    (
        "factors_from_scratch",
        "Whether the factors were counted afresh instead of updated.",
    ),
    (
        "seconds.candidates",
        "Seconds to put the movers in their places and box them.",
    ),
    (
        "seconds.factors",
        "Seconds to find the samples to ask, and to ask them.",
    ),
    ("seconds.solve", "Seconds to solve for radiosity."),
    ("seconds.image", "Seconds to make the image."),
    ("seconds.write", "Seconds to write the files."),
    (
        "seconds.from_scratch",
        "Seconds of candidates, factors and solve from scratch, measured beside it.",
    ),
];

/// All other figures.
pub(super) const FIGURES: &[(&str, &str)] = &[
    ("verified.frames", "Frames compared."),
    ("verified.samples", "Samples of each frame."),
    (
        "verified.differ",
        "Samples, over all frames, whose answer or irradiance differs from a full trace; must be 0.",
    ),
    (
        "verified.pixels_differ",
        "Pixels, over all frames, whose hits or direct light differ; must be 0.",
    ),
    (
        "verified.largest_difference",
        "Largest difference of any radiosity, relative to the root mean square of its frame.",
    ),
    (
        "verified.allowed_difference",
        "Twice the solver's tolerance: each of two solves may be off by it.",
    ),
    (
        "verified.incremental_seconds",
        "Median seconds of a frame's light with reuse, the first frame left out.",
    ),
    (
        "verified.scratch_seconds",
        "Median seconds of the same from scratch.",
    ),
    (
        "verified.ratio",
        "The one over the other: how many times faster reuse was.",
    ),
    (
        "verified.candidates",
        "Candidates over all frames but the first.",
    ),
    (
        "verified.changed",
        "Changed samples over all frames but the first.",
    ),
    ("total.frames", "Frames rendered."),
    (
        "total.saving",
        "1 − candidates ÷ samples, over the frames after the first.",
    ),
    (
        "total.oracle_saving",
        "1 − changed ÷ samples, over the frames after the first: the most that could be saved.",
    ),
    (
        "total.tightness",
        "Changed ÷ candidates, over the frames after the first.",
    ),
    (
        "total.saving_with_first",
        "1 − candidates ÷ samples, over all frames; the first has nothing to keep.",
    ),
    (
        "total.oracle_saving_with_first",
        "1 − changed ÷ samples, over all frames.",
    ),
    (
        "total.break_even_frame",
        "The first frame by which preparation and all light so far took no longer than from scratch.",
    ),
    ("total.samples", "Samples of all frames."),
    (
        "total.candidates",
        "Samples tested or traced again, the whole first frame among them.",
    ),
    (
        "total.changed",
        "Samples whose answer changed, the whole first frame among them.",
    ),
    (
        "total.pairs_changed",
        "Pairs of patches whose form factor changed, over all frames.",
    ),
    ("total.pixels", "Pixels of all frames."),
    (
        "total.pixels_recomputed",
        "Pixels of which anything was asked again, over all frames.",
    ),
    ("total.sweeps", "Passes of the solver, over all frames."),
    (
        "total.shots",
        "Shots of a progressive solver, over all frames.",
    ),
    (
        "total.seconds.candidates",
        "Seconds of putting the movers in their places, over all frames.",
    ),
    (
        "total.seconds.factors",
        "Seconds of asking samples, over all frames.",
    ),
    (
        "total.seconds.solve",
        "Seconds of solving, over all frames.",
    ),
    (
        "total.seconds.image",
        "Seconds of making images, over all frames.",
    ),
    (
        "total.seconds.write",
        "Seconds of writing files, over all frames.",
    ),
    ("settings.scene", "The scene file."),
    (
        "settings.quality",
        "The preset of what is not set by itself.",
    ),
    (
        "settings.mesh",
        "Whether edges may be as long everywhere, or follow what a pilot run found to be needed.",
    ),
    (
        "settings.element_size",
        "Longest edge of an element, in metres; of an adaptive mesh, that of a uniform one of as many.",
    ),
    (
        "settings.form_factors",
        "How hemisphere samples are spread: by the cosine, as a hemicube's pixels, or as a plane's cells.",
    ),
    (
        "settings.samples",
        "Hemisphere samples of each receiver that rests.",
    ),
    (
        "settings.moving_samples",
        "Hemisphere samples of each receiver on a mover.",
    ),
    (
        "settings.weight_sums",
        "What all factors of either came to before they were divided by it: a plane's rim loses some.",
    ),
    (
        "settings.light_samples",
        "Light samples of each receiver.",
    ),
    (
        "settings.solver",
        "How rows become light: gathering, or progressive refinement.",
    ),
    (
        "settings.memory",
        "Whether answers were kept from frame to frame, or asked for when needed and forgotten.",
    ),
    (
        "settings.pairs",
        "Which pairs of patches took their factor by the contour integral; all others are sampled.",
    ),
    (
        "settings.patch_elements",
        "Elements at most that sent light as one patch; they received it each for itself.",
    ),
    (
        "settings.pixel_samples",
        "Primary samples of a pixel; edges take four times as many.",
    ),
    (
        "settings.finish",
        "How indirect light gets to pixels: interpolated between elements, gathered by each pixel, or both.",
    ),
    (
        "settings.finish_samples",
        "Directions in which each plane of a pixel that gathers looks.",
    ),
    ("settings.size", "Width and height in pixels."),
    ("settings.fps", "Frames per second."),
    (
        "settings.light.sky",
        "What is seen where a ray leaves the scene; none is black.",
    ),
    (
        "settings.light.sky.even",
        "Radiance of a sky that is the same everywhere, RGB.",
    ),
    ("settings.light.sky.picture", "The picture of the sky."),
    ("settings.light.sun", "A sun beside the lights of the file."),
    (
        "settings.light.sun.azimuth",
        "Where the sun stands, in degrees from −z towards +x.",
    ),
    (
        "settings.light.sun.elevation",
        "How high it stands above the horizon, in degrees.",
    ),
    (
        "settings.light.sun.irradiance",
        "Its irradiance on a surface that faces it.",
    ),
    ("settings.light.sun.color", "What multiplies that, RGB."),
    (
        "settings.light.sun.diameter",
        "The angle under which it is seen, in degrees.",
    ),
    (
        "settings.light.units",
        "On which scale the file's lights stand.",
    ),
    (
        "settings.light.scale",
        "What multiplies the intensity of the file's lights.",
    ),
    (
        "settings.light.emission_scale",
        "What multiplies the radiance of the file's materials.",
    ),
    (
        "settings.exposure",
        "Exposure in stops, or the file that has one for each frame.",
    ),
    ("settings.film.tone", "The tone curve of PNG and video."),
    ("settings.film.png_bits", "Bits of a PNG's channels."),
    (
        "settings.film.aovs",
        "What EXR files hold beside the picture.",
    ),
    (
        "settings.film.filter",
        "How a pixel weighs what is around it.",
    ),
    (
        "settings.film.filter_radius",
        "Pixels from the middle of a pixel to the end of a Gaussian.",
    ),
    ("settings.film.lens", "The lens, or none for a pinhole."),
    ("settings.film.lens.f_stop", "Focal length over diameter."),
    (
        "settings.film.lens.focus",
        "Metres along the view, or the node, that are sharp.",
    ),
    (
        "settings.film.shutter",
        "How long the shutter is open, as a part of the time from frame to frame.",
    ),
    (
        "settings.film.sub_frames",
        "Moments that a frame is the mean of while the shutter is open.",
    ),
    (
        "settings.threads",
        "Worker threads; no result depends on them.",
    ),
    (
        "settings.from_scratch",
        "Whether every frame was traced and solved afresh.",
    ),
    (
        "settings.tolerance",
        "The error that a solve may leave, relative to the root mean square of the reflected light.",
    ),
    ("scene.triangles", "Triangles of the file."),
    ("scene.elements", "Elements they were cut into."),
    ("scene.sides", "Sides of elements that have a radiosity."),
    (
        "scene.sides_solved",
        "Sides whose radiosity is solved for: those that light can reach.",
    ),
    ("scene.movers", "Nodes that move and carry triangles."),
    ("scene.emitters", "Elements that emit."),
    ("scene.samples", "Form-factor samples of a frame."),
    (
        "scene.memory_bytes",
        "Bytes of the structures that live through the run.",
    ),
    (
        "scene.memory_full_bytes",
        "The same with every answer kept; at least, where they were not.",
    ),
    (
        "scene.pairs_lit",
        "Pairs of a receiver and a piece of an emitter, whose factors are formulas times what samples see of them.",
    ),
    ("schema", "The name of the report's form."),
    (
        "preparation",
        "Seconds before the first frame: patches, swept volume, static answers.",
    ),
    (
        "pilot",
        "Seconds of preparation in which a pilot run found where elements need to be small.",
    ),
    (
        "scratch_seconds",
        "Seconds of a frame's light from scratch, measured on average or estimated.",
    ),
];

/// What a list says of a figure.
pub(super) fn meaning(list: &[(&str, &'static str)], name: &str) -> Option<&'static str> {
    list.iter()
        .find(|(known, _)| *known == name)
        .map(|(_, meaning)| *meaning)
}
