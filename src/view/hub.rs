//! Between the solver and the tabs: the latest state, and answers for each tab.
//!
//! The solver puts a state here and goes on; each tab takes the latest when it has sent what it took before. So a slow
//! tab misses states and holds nobody up.

use super::snapshot::Snapshot;
use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tungstenite::Message as Frame;

/// Tabs at a time.
pub(super) const MOST_TABS: usize = 16;

/// Answers that wait for a tab; the oldest give way.
const MOST_ANSWERS: usize = 64;

/// The meeting place.
pub(super) struct Hub {
    board: Mutex<Board>,
    changed: Condvar,
}

struct Board {
    latest: Option<Arc<Snapshot>>,
    /// What is done before there is a state.
    opening: String,
    answers: HashMap<u64, VecDeque<Frame>>,
    next: u64,
    /// When the last tab left, if there was one and there is none now.
    empty_since: Option<Instant>,
    ended: bool,
}

/// What a tab is to send.
pub(super) struct Mail {
    pub(super) answers: Vec<Frame>,
    pub(super) latest: Option<Arc<Snapshot>>,
    pub(super) opening: Option<String>,
    pub(super) ended: bool,
}

impl Hub {
    pub(super) fn new() -> Hub {
        Hub {
            board: Mutex::new(Board {
                latest: None,
                opening: "opens the scene".into(),
                answers: HashMap::new(),
                next: 1,
                empty_since: None,
                ended: false,
            }),
            changed: Condvar::new(),
        }
    }

    fn board(&self) -> MutexGuard<'_, Board> {
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A new tab's number; `None` where there are too many.
    pub(super) fn enter(&self) -> Option<u64> {
        let mut board = self.board();
        if board.answers.len() >= MOST_TABS || board.ended {
            return None;
        }
        let tab = board.next;
        board.next += 1;
        board.answers.insert(tab, VecDeque::new());
        board.empty_since = None;
        Some(tab)
    }

    /// A tab goes.
    pub(super) fn leave(&self, tab: u64) {
        let mut board = self.board();
        board.answers.remove(&tab);
        if board.answers.is_empty() {
            board.empty_since = Some(Instant::now());
        }
        drop(board);
        self.changed.notify_all();
    }

    /// How long all tabs have been closed; `None` while one is open, or none ever was.
    pub(super) fn deserted(&self) -> Option<Duration> {
        self.board().empty_since.map(|since| since.elapsed())
    }

    /// Tells tabs what is done before there is a state.
    pub(super) fn opening(&self, told: &str) {
        self.board().opening = told.into();
        self.changed.notify_all();
    }

    /// Shows a state.
    pub(super) fn show(&self, snapshot: Snapshot) {
        self.board().latest = Some(Arc::new(snapshot));
        self.changed.notify_all();
    }

    /// The latest state.
    pub(super) fn latest(&self) -> Option<Arc<Snapshot>> {
        self.board().latest.clone()
    }

    /// Answers a tab, if it is still there.
    pub(super) fn answer(&self, tab: u64, answer: Frame) {
        if let Some(answers) = self.board().answers.get_mut(&tab) {
            if answers.len() >= MOST_ANSWERS {
                answers.pop_front();
            }
            answers.push_back(answer);
        }
        self.changed.notify_all();
    }

    /// Lets all tabs go.
    pub(super) fn end(&self) {
        self.board().ended = true;
        self.changed.notify_all();
    }

    /// Waits until there is something for a tab that has seen a state and was told of an opening, or until a time has passed.
    pub(super) fn wait(&self, tab: u64, seen: u64, told: &str, longest: Duration) -> Mail {
        let nothing = |board: &mut Board| {
            let answers = board.answers.get(&tab);
            let idle = answers.is_some_and(VecDeque::is_empty);
            idle && !board.ended && !board.is_news(seen, told)
        };
        let waited = self
            .changed
            .wait_timeout_while(self.board(), longest, nothing);
        let (mut board, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let latest = board.latest.clone();
        let is_new = latest.as_ref().is_some_and(|latest| latest.revision > seen);
        let opening = (latest.is_none() && board.opening != told).then(|| board.opening.clone());
        let gone = !board.answers.contains_key(&tab);
        let answers = board.answers.get_mut(&tab).map(std::mem::take);
        Mail {
            answers: answers.unwrap_or_default().into(),
            latest: latest.filter(|_| is_new),
            opening,
            ended: gone || board.ended,
        }
    }
}

impl Board {
    fn is_news(&self, seen: u64, told: &str) -> bool {
        match &self.latest {
            Some(latest) => latest.revision > seen,
            None => self.opening != told,
        }
    }
}
