//! Figure 16 of Drucker's survey: how fast gathering, shooting, shooting with sorting, and that with the ambient term come near.
//!
//! Cohen, Chen, Wallace, Greenberg 1988, "A progressive refinement approach to fast radiosity image generation", Computer
//! Graphics 22(4):75–84, whose figure it is. A step gathers or shoots once, and finds the one row of form factors for it anew, as
//! they do, who have no room to store any: so rows count the work. All four solve one and the same matrix, since factors are
//! exactly reciprocal. Patches that are not sorted come in one shuffled order.

use super::figure_room::{self, RoomTile};
use crate::formfactor::sobol::scatter;
use crate::sequence::observer::Event;
use crate::solver::{dense, solution};
use glam::DVec3;
use serde::Serialize;
use std::time::Instant;

/// Edge of a tile in metres.
const EDGE: f64 = 0.5;

/// Errors are noted after so many steps evenly, and at the start.
const NOTES: usize = 48;

/// Steps of a method, as a multiple of the tiles.
const ROUNDS: usize = 2;

/// The reference changes by less than this in its last sweep.
const TOLERANCE: f64 = 1e-12;

/// A way to solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SolveOrder {
    /// Each patch gathers in turn: Gauss and Seidel.
    Gathering,
    /// Each patch shoots in turn.
    Shooting,
    /// The patch with most unshot light shoots.
    Sorting,
    /// The same, shown with the ambient term for what is unshot.
    Ambient,
}

/// How the error of one method falls.
#[derive(Clone, Debug, Serialize)]
pub struct SolveCurve {
    /// The method.
    pub order: SolveOrder,
    /// Rows of form factors found so far.
    pub rows: Vec<u64>,
    /// Form factors found so far.
    pub factors: Vec<u64>,
    /// Seconds so far.
    pub seconds: Vec<f64>,
    /// Root mean square over all areas of the error of reflected light, relative to that of reflected light.
    pub errors: Vec<f64>,
}

/// All four.
#[derive(Clone, Debug, Serialize)]
pub struct Figure16 {
    /// Patches of the room.
    pub patches: usize,
    /// The curves.
    pub curves: Vec<SolveCurve>,
}

/// A solve on its way.
struct Course {
    tiles: Vec<RoomTile>,
    /// The radiosities it leads to.
    goal: Vec<DVec3>,
    radiosity: Vec<DVec3>,
    unshot: Vec<DVec3>,
}

impl SolveOrder {
    /// All of them, as the figure has them.
    pub const ALL: [SolveOrder; 4] = [
        SolveOrder::Gathering,
        SolveOrder::Shooting,
        SolveOrder::Sorting,
        SolveOrder::Ambient,
    ];

    /// Its name in the figure.
    pub fn name(self) -> &'static str {
        match self {
            SolveOrder::Gathering => "gathering",
            SolveOrder::Shooting => "shooting",
            SolveOrder::Sorting => "shooting, sorting",
            SolveOrder::Ambient => "shooting, sorting, ambient",
        }
    }
}

/// Solves the room in all four ways.
pub fn figure_16(watch: &(dyn Fn(Event) + Sync)) -> Figure16 {
    let tiles = figure_room::tiles(EDGE);
    let steps = ROUNDS * tiles.len();
    watch(Event::Stage {
        name: "figure 16",
        total: (4 * NOTES) as u64,
    });
    let goal = solved(&tiles);
    let curve = |order: SolveOrder| Course::start(&tiles, &goal).run(order, steps, watch);
    Figure16 {
        patches: tiles.len(),
        curves: SolveOrder::ALL.map(curve).to_vec(),
    }
}

/// The radiosities of the room, by the full matrix.
fn solved(tiles: &[RoomTile]) -> Vec<DVec3> {
    let row = |i: usize| {
        let exchanges = figure_room::exchanges(tiles, i);
        exchanges
            .into_iter()
            .map(move |exchange| exchange / tiles[i].area)
    };
    let factors: Vec<f64> = (0..tiles.len()).flat_map(row).collect();
    let emission: Vec<DVec3> = tiles.iter().map(|tile| tile.emission).collect();
    let reflectance: Vec<DVec3> = tiles.iter().map(|tile| tile.reflectance).collect();
    dense::gauss_seidel(&factors, &emission, &reflectance, TOLERANCE)
}

impl Course {
    /// Before the first step: what emits is known, and nothing else.
    fn start(tiles: &[RoomTile], goal: &[DVec3]) -> Course {
        let emission: Vec<DVec3> = tiles.iter().map(|tile| tile.emission).collect();
        Course {
            tiles: tiles.to_vec(),
            goal: goal.to_vec(),
            radiosity: emission.clone(),
            unshot: emission,
        }
    }

    /// Takes so many steps, and notes the error on the way.
    fn run(
        mut self,
        order: SolveOrder,
        steps: usize,
        watch: &(dyn Fn(Event) + Sync),
    ) -> SolveCurve {
        let mut turns: Vec<usize> = (0..self.tiles.len()).collect();
        turns.sort_by_key(|tile| scatter(*tile as u32));
        let mut curve = SolveCurve {
            order,
            rows: Vec::new(),
            factors: Vec::new(),
            seconds: Vec::new(),
            errors: Vec::new(),
        };
        let noted: Vec<usize> = (0..=NOTES).map(|note| note * steps / NOTES).collect();
        let mut spent = 0.0;
        for step in 0..=steps {
            if noted.binary_search(&step).is_ok() {
                curve.rows.push(step as u64);
                curve.factors.push((step * self.tiles.len()) as u64);
                curve.seconds.push(spent);
                curve.errors.push(self.error(order));
                watch(Event::Advance(u64::from(step > 0)));
            }
            let start = Instant::now();
            let turn = turns[step % turns.len()];
            match order {
                SolveOrder::Gathering => self.gather(turn),
                SolveOrder::Shooting => self.shoot(turn),
                SolveOrder::Sorting | SolveOrder::Ambient => self.shoot(self.brightest()),
            }
            spent += start.elapsed().as_secs_f64();
        }
        curve
    }

    /// Equation 29: a patch gathers what all others send.
    fn gather(&mut self, i: usize) {
        let row = figure_room::exchanges(&self.tiles, i);
        let arriving = row.iter().zip(&self.radiosity).map(|(e, b)| *b * *e);
        let irradiance = arriving.sum::<DVec3>() / self.tiles[i].area;
        self.radiosity[i] = self.tiles[i].emission + self.tiles[i].reflectance * irradiance;
    }

    /// Equation 30: a patch sends its unshot radiosity to all others.
    fn shoot(&mut self, i: usize) {
        let light = std::mem::take(&mut self.unshot[i]);
        let row = figure_room::exchanges(&self.tiles, i);
        for (j, exchange) in row.into_iter().enumerate() {
            let tile = &self.tiles[j];
            let more = tile.reflectance * light * (exchange / tile.area);
            self.radiosity[j] += more;
            self.unshot[j] += more;
        }
    }

    /// The patch with most unshot light.
    fn brightest(&self) -> usize {
        let light = |i: &usize| self.unshot[*i].element_sum() * self.tiles[*i].area;
        let all = 0..self.tiles.len();
        all.max_by(|a, b| light(a).total_cmp(&light(b)))
            .unwrap_or(0)
    }

    /// The error of what would be shown now.
    fn error(&self, order: SolveOrder) -> f64 {
        let ambient = match order {
            SolveOrder::Ambient => self.ambient(),
            _ => DVec3::ZERO,
        };
        let (mut off, mut all) = (0.0, 0.0);
        for (i, tile) in self.tiles.iter().enumerate() {
            let shown = self.radiosity[i] + tile.reflectance * ambient;
            off += tile.area * (shown - self.goal[i]).length_squared();
            all += tile.area * (self.goal[i] - tile.emission).length_squared();
        }
        (off / all).sqrt()
    }

    /// Equations 31 to 34.
    fn ambient(&self) -> DVec3 {
        let area: f64 = self.tiles.iter().map(|tile| tile.area).sum();
        let unshot = self.tiles.iter().zip(&self.unshot);
        let unshot: DVec3 = unshot.map(|(tile, light)| *light * tile.area).sum();
        let reflectance: DVec3 = self.tiles.iter().map(|t| t.reflectance * t.area).sum();
        solution::ambient(area, unshot, reflectance).as_dvec3()
    }
}

impl Figure16 {
    /// The figure as text: rows, and the error of each method.
    pub fn text(&self) -> String {
        let mut text = format!(
            "Figure 16: {} patches; error after so many rows of form factors\n{:>8}",
            self.patches, "rows"
        );
        for curve in &self.curves {
            text += &format!(" {:>27}", curve.order.name());
        }
        text += "\n";
        let rows = &self.curves[0].rows;
        for at in (0..rows.len()).step_by(4) {
            text += &format!("{:8}", rows[at]);
            for curve in &self.curves {
                text += &format!(" {:27.6}", curve.errors[at]);
            }
            text += "\n";
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::silence;

    /// Cohen's order: gathering is slowest, sorting helps shooting, and the ambient term is best while little has been shot.
    #[test]
    fn the_curves_have_the_order_of_cohen_1988() {
        let figure = figure_16(&silence);
        let [gathering, shooting, sorting, ambient] = &figure.curves[..] else {
            panic!("{} curves", figure.curves.len());
        };
        let round = NOTES / ROUNDS;
        let mean = |curve: &SolveCurve| curve.errors[1..=round].iter().sum::<f64>() / round as f64;
        let means = [gathering, shooting, sorting, ambient].map(mean);
        assert!(means.is_sorted_by(|a, b| a > b), "{means:?}");
        for at in 1..=round {
            assert!(sorting.errors[at] < shooting.errors[at], "{at}");
            assert!(sorting.errors[at] < gathering.errors[at], "{at}");
        }
        for at in 0..=round / 2 {
            assert!(ambient.errors[at] < sorting.errors[at], "{at}");
        }
        // Dark at first, and all the same light in the end.
        assert!((gathering.errors[0] - 1.0).abs() < 1e-12);
        for curve in &figure.curves {
            assert_eq!(curve.errors.len(), NOTES + 1);
            assert_eq!(curve.rows.last(), Some(&((ROUNDS * figure.patches) as u64)));
            assert!(
                curve.errors[NOTES] < 0.3,
                "{:?} {}",
                curve.order,
                curve.errors[NOTES]
            );
            assert!(curve.seconds.is_sorted());
        }
        assert!(sorting.errors[NOTES] < 0.15 && ambient.errors[NOTES] < 0.02);
    }
}
