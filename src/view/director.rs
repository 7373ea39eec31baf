//! The thread that owns the session: it takes the tabs' messages, makes states, and shows them on the hub.
//!
//! While a hand moves, messages that a later one replaces are passed over, and light is redistributed within a budget; when it
//! rests, what the budget left is shot to the tolerance, and then the responses to lamps and colours are found. A message
//! that cannot be done is answered, and changes nothing.

use super::clock::Clock;
use super::delta::PICTURE;
use super::describe;
use super::folder;
use super::hand::Hand;
use super::hub::Hub;
use super::message::{Ask, Carry, PictureOrder};
use super::pace::Pace;
use super::record::Record;
use super::shot;
use super::snapshot::{self, MeshSnapshot, Snapshot};
use super::tab::TabMessage;
use crate::error::Result;
use crate::export::drawn::DrawnMesh;
use crate::image::Tone;
use crate::report::FrameReport;
use crate::session::{Edit, Session, Step};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};
use tungstenite::Message as Frame;

/// A hand that has not moved for so long rests.
const REST: Duration = Duration::from_millis(120);

/// Time from one state of a playing clip to the next, at least.
const TICK: Duration = Duration::from_millis(33);

/// How often it is looked whether all tabs have gone.
const LOOK: Duration = Duration::from_millis(500);

/// How long the program goes on without a tab: one that is loaded again comes back in a second.
const DESERTED: Duration = Duration::from_secs(10);

/// What a director begins with.
pub(super) struct Opening {
    pub(super) session: Session,
    pub(super) report: FrameReport,
    pub(super) tone: Tone,
    pub(super) fps: f64,
    pub(super) folder: PathBuf,
    /// Whether the program goes on without a tab.
    pub(super) keep: bool,
}

/// The session with all that stands around it.
pub(super) struct Director {
    opening: Opening,
    hub: Arc<Hub>,
    stage: Arc<MeshSnapshot>,
    record: Record,
    clock: Clock,
    hand: Option<Hand>,
    pace: Pace,
    revision: u64,
    heard: Vec<(u64, u64)>,
    /// The account of the last step of edits or of the clock, with what its light took when the hand rested.
    account: FrameReport,
    /// Seconds of light from scratch, as the opening took them.
    scratch: f64,
    /// Whether the last state shown is a moving hand's.
    is_coarse: bool,
    /// Whether there is more to find out between steps.
    is_curious: bool,
}

/// What a message came to: the error is for its sender.
type Done = std::result::Result<(), String>;

fn told(error: crate::error::Error) -> String {
    error.to_string()
}

impl Director {
    pub(super) fn new(opening: Opening, hub: Arc<Hub>) -> Director {
        Director {
            stage: Arc::new(stage(&opening, 1)),
            record: Record::default(),
            clock: Clock::new(opening.session.scene.animation.seconds()),
            hand: None,
            pace: Pace::default(),
            revision: 0,
            heard: Vec::new(),
            account: opening.report.clone(),
            scratch: opening.report.seconds.light(),
            is_coarse: false,
            is_curious: true,
            opening,
            hub,
        }
    }

    /// Directs until all tabs have gone for good.
    pub(super) fn run(mut self, inbox: &Receiver<TabMessage>) -> Result<()> {
        self.show();
        loop {
            match inbox.recv_timeout(self.patience()) {
                Ok(first) => {
                    let batch: Vec<TabMessage> =
                        std::iter::once(first).chain(inbox.try_iter()).collect();
                    self.take(batch);
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
            if self.clock.plays() {
                self.tick();
            } else {
                self.rest();
            }
            let deserted = self.hub.deserted();
            if !self.opening.keep && deserted.is_some_and(|since| since > DESERTED) {
                return Ok(());
            }
        }
    }

    /// How long to wait for a message before going on.
    fn patience(&self) -> Duration {
        if self.clock.plays() {
            TICK
        } else if self.is_coarse {
            REST
        } else if self.is_curious {
            2 * REST
        } else {
            LOOK
        }
    }

    /// Answers messages in order, but for those that a later one replaces.
    fn take(&mut self, batch: Vec<TabMessage>) {
        for (at, asked) in batch.iter().enumerate() {
            let (tab, id) = (asked.tab, asked.message.id);
            let mut later = batch[at + 1..].iter().filter(|other| other.tab == tab);
            if later
                .next()
                .is_some_and(|next| asked.message.ask.gives_way_to(&next.message.ask))
            {
                continue;
            }
            self.heard.retain(|(of, _)| *of != tab);
            self.heard.push((tab, id));
            if let Err(error) = self.answer(tab, id, &asked.message.ask) {
                self.tell(tab, &json!({ "error": error, "id": id }));
            }
        }
    }

    fn tell(&self, tab: u64, answer: &Value) {
        self.hub.answer(tab, Frame::text(answer.to_string()));
    }

    fn answer(&mut self, tab: u64, id: u64, ask: &Ask) -> Done {
        match ask {
            Ask::Step { edits, gesture } => {
                let gesture = gesture.map(|gesture| (tab, gesture));
                self.step(edits.clone(), gesture)
            }
            Ask::Place {
                node,
                gesture,
                places,
            } => self.place(*node, (tab, *gesture), places),
            Ask::Undo {} => self.undo(),
            Ask::Play { on } => {
                self.clock.play(*on);
                self.tick();
                Ok(())
            }
            Ask::Seek { seconds } => {
                self.clock.seek(*seconds);
                self.tick();
                Ok(())
            }
            Ask::Render(order) => self.render(tab, id, order),
            Ask::Verify {} => self.verify(tab, id),
            Ask::Lines {} => {
                self.tell(tab, &json!({ "lines": self.record.text(), "id": id }));
                Ok(())
            }
        }
    }

    fn step(&mut self, mut edits: Value, gesture: Option<(u64, u64)>) -> Done {
        if edits.as_array().is_none_or(Vec::is_empty) {
            return Err("edits: expected a list of edits, got none — send at least one".into());
        }
        folder::keep_within(&mut edits, &self.opening.folder)?;
        let line = json!({ "edits": edits }).to_string();
        let step = Step::parse(&line).map_err(told)?;
        if step.edits.iter().any(|edit| matches!(edit, Edit::Undo(_))) {
            return Err(
                "edits: expected no undo among them, got one — send {\"do\":\"undo\"}".into(),
            );
        }
        let report = self.apply(&step.edits, gesture.map(|_| self.pace.moving()))?;
        self.record.note(&line, edits, gesture);
        self.is_coarse = gesture.is_some();
        self.account = report;
        self.show();
        Ok(())
    }

    fn place(&mut self, node: usize, gesture: (u64, u64), places: &Carry) -> Done {
        let known = self.hand.take().filter(|hand| hand.is_of(node, gesture));
        let hand = match known {
            Some(hand) => hand,
            None => Hand::take(&self.opening.session, node, gesture)?,
        };
        let edits = hand.edits(&self.opening.session, places);
        self.hand = Some(hand);
        self.step(edits?, Some(gesture))
    }

    fn undo(&mut self) -> Done {
        let steps = self.record.last_steps();
        let steps = steps.ok_or("undo: expected a step to take back, got none — edit first")?;
        self.hand = None;
        let report = self.apply(&[Edit::Undo(steps)], None)?;
        self.record.forget_last();
        self.account = report;
        self.show();
        Ok(())
    }

    fn apply(
        &mut self,
        edits: &[Edit],
        budget: Option<Duration>,
    ) -> std::result::Result<FrameReport, String> {
        self.is_curious = true;
        let session = &mut self.opening.session;
        session.numbers.budget = budget;
        let done = session.apply(edits);
        session.numbers.budget = None;
        if let Ok(report) = &done {
            self.pace.learn(report, session.is_settled());
        }
        done.map_err(told)
    }

    /// Shows the clips at the time of the clock.
    fn tick(&mut self) {
        self.opening.session.play(self.clock.seconds());
        if let Ok(report) = self.apply(&[], Some(self.pace.moving())) {
            self.is_coarse = true;
            self.account = report;
            self.show();
        }
    }

    /// Goes on with what a moving hand left, then finds out what the next steps would have to.
    fn rest(&mut self) {
        if self.is_coarse {
            let mut goes_on = !self.opening.session.is_settled();
            if goes_on {
                let more = self.apply(&[], Some(self.pace.resting()));
                goes_on = more.is_ok() && !self.opening.session.is_settled();
                let more = more.unwrap_or_default();
                self.account.shots += more.shots;
                self.account.sweeps += more.sweeps;
                self.account.seconds.solve += more.seconds.solve;
            }
            if !goes_on {
                self.is_coarse = false;
                self.show();
            }
        } else if self.is_curious {
            self.is_curious = self.opening.session.precompute();
        }
    }

    fn render(&mut self, tab: u64, id: u64, order: &PictureOrder) -> Done {
        let start = Instant::now();
        let png = shot::png(&mut self.opening.session, order)?;
        let ms = 1e3 * start.elapsed().as_secs_f64();
        self.tell(tab, &json!({ "rendered": { "ms": ms }, "id": id }));
        let words = [PICTURE, id as u32].map(u32::to_le_bytes).concat();
        self.hub.answer(tab, Frame::binary([words, png].concat()));
        Ok(())
    }

    fn verify(&self, tab: u64, id: u64) -> Done {
        let verified = self.opening.session.verify();
        let holds = verified.holds();
        let answer = json!({ "verified": verified, "holds": holds, "id": id });
        self.tell(tab, &answer);
        Ok(())
    }

    /// Shows the present state.
    fn show(&mut self) {
        let session = &self.opening.session;
        let sides = session.scene.patches.sides.len();
        if self.stage.drawn.sides as usize != sides
            || self.stage.drawn.objects.len() != session.scene.patches.surfaces.len()
        {
            self.stage = Arc::new(stage(&self.opening, self.stage.epoch + 1));
        }
        self.revision += 1;
        self.hub.show(Snapshot {
            stage: self.stage.clone(),
            revision: self.revision,
            is_coarse: self.is_coarse,
            corners: self.stage.drawn.corners(session),
            light: snapshot::light(session),
            heat: snapshot::heat(session),
            fields: self.fields(),
            heard: self.heard.clone(),
        });
    }

    /// The account of a step, and what panels show, as the inside of a JSON object.
    fn fields(&self) -> String {
        let session = &self.opening.session;
        let report = &self.account;
        let seconds = report.seconds;
        let mut fields = describe::values(session, &self.stage.drawn);
        fields.extend([
            ("lines", json!(self.record.len())),
            ("seconds", json!(session.seconds())),
            ("plays", json!(self.clock.plays())),
            ("coarse", json!(self.is_coarse)),
            ("residual", json!(session.residual())),
            (
                "step",
                json!({
                    "samples": report.samples, "traced": report.traced, "changed": report.changed,
                    "shots": report.shots, "sweeps": report.sweeps,
                    "place_ms": 1e3 * seconds.place, "trace_ms": 1e3 * seconds.trace,
                    "solve_ms": 1e3 * seconds.solve, "scratch_ms": 1e3 * self.scratch,
                }),
            ),
        ]);
        let fields = fields
            .iter()
            .map(|(name, value)| format!("\"{name}\":{value}"));
        fields.collect::<Vec<_>>().join(",")
    }
}

/// What does not change until something is added.
fn stage(opening: &Opening, epoch: u32) -> MeshSnapshot {
    let session = &opening.session;
    let drawn = DrawnMesh::of(session);
    let files = folder::scenes(&opening.folder);
    let about = describe::about(session, &drawn, epoch, (opening.tone, &files, opening.fps));
    let textures = session.scene.animation.textures.iter();
    MeshSnapshot {
        epoch,
        about,
        pictures: textures.map(|texture| texture.picture.clone()).collect(),
        drawn,
    }
}
