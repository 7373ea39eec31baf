//! What phases took beside their wall-clock time: CPU seconds, and rays.

/// What a phase took beside its wall-clock time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// CPU seconds of all threads.
    pub cpu_seconds: f64,
    /// Rays through trees of triangles; a ray through two trees counts twice.
    pub rays: u64,
}

/// The costs of the phases.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Costs {
    /// Of posing the movers and building boxes and trees over them.
    pub place: Cost,
    /// Of tracing.
    pub trace: Cost,
    /// Of solving.
    pub solve: Cost,
    /// Of the image.
    pub image: Cost,
    /// Of writing files.
    pub write: Cost,
}

impl Cost {
    /// Adds another.
    pub fn add(&mut self, other: &Cost) {
        self.cpu_seconds += other.cpu_seconds;
        self.rays += other.rays;
    }
}

impl Costs {
    /// Adds those of another moment or frame.
    pub fn add(&mut self, other: &Costs) {
        self.place.add(&other.place);
        self.trace.add(&other.trace);
        self.solve.add(&other.solve);
        self.image.add(&other.image);
        self.write.add(&other.write);
    }
}
