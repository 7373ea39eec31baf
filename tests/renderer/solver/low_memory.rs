//! `--memory low`: the light of kept answers within sampling error, in memory that does not grow with samples.

use crate::support::program::{done, moving, quick, refused, stdout};
use crate::support::run::case;
use glam::Vec3;
use serde_json::Value;
use std::fs;
use sweeplight::sequence::prepared::Prepared;
use sweeplight::sequence::step::State;
use sweeplight::settings::{Memory, Solver};
use sweeplight::solver::Transpose;

/// Indirect irradiance H of every side in every frame is that of kept answers within sampling error.
///
/// Both gather H over the same rows F; their R come of two matrices that sample the same factors. In one bounce each R_j
/// errs by ρ_j √(v_j/n) for each matrix, v_j being the variance of R over what j sees and n the samples that saw it, at
/// least N/8, as many as a receiver on a mover has. These errors are independent, so that of H_i has the variance
/// Σ F_ij² · 2 ρ_j² v_j/n, and all echoes at most 1/(1 − ρ) of that deviation: this bounds the root mean square over
/// the sides. The mean over all, where errors cancel, keeps within a quarter of it.
#[test]
fn kept_answers_have_the_same_light() {
    const N: u32 = 256;
    let mut full = case(&moving());
    full.settings.solve.samples = Some(N);
    let mut low = case(&moving());
    low.settings.solve.samples = Some(N);
    (low.settings.solve.memory, low.settings.solve.solver) = (Memory::Low, Solver::Progressive);
    let prepared = low.prepare();
    let reflectance = prepared.patches.reflectances(&prepared.rest);
    let most = reflectance
        .iter()
        .fold(0.0f32, |most, r| most.max(r.max_element()));
    let n = prepared.patches.sides.len();
    let mut kept = Vec::new();
    full.walk_light(&full.prepare(), |state, _| {
        let error = expected(&prepared, state, &reflectance, N as f32 / 8.0) / (1.0 - most);
        kept.push((state.light.indirect.clone(), state.view.direct(), error));
    });
    let (mut frames, mut shots) = (kept.into_iter(), Vec::new());
    low.walk_light(&prepared, |state, report| {
        let (indirect, direct, error) = frames.next().expect("as many frames");
        assert_eq!(state.view.direct(), direct, "light samples are the same");
        assert_eq!((report.traced, report.sweeps), (report.samples, 0));
        let off = |i: usize| state.light.indirect[i] - indirect[i];
        let squares: f32 = (0..n).map(|i| off(i).length_squared()).sum();
        let rms = (squares / (3 * n) as f32).sqrt();
        let mean = (0..n).map(off).sum::<Vec3>().abs().max_element() / n as f32;
        assert!(rms < error, "frame {}: {rms:e} of {error:e}", report.frame);
        assert!(
            mean < 0.25 * error,
            "frame {}: {mean:e} of {error:e}",
            report.frame
        );
        shots.push(report.shots);
    });
    // Later frames go on from the light of the one before.
    assert!(
        shots[1..].iter().all(|later| *later < shots[0]),
        "{shots:?}"
    );
}

/// The root mean square over sides and channels of what one bounce of two matrices of `samples` leaves in H.
fn expected(prepared: &Prepared, state: &State, reflectance: &[Vec3], samples: f32) -> f32 {
    let (shares, light) = (prepared.back.shares(&state.view), &state.light.reflected);
    let rows = prepared.rows(&state.view, &shares);
    let n = rows.len();
    let variance = |i: usize| {
        let mean = |of: &dyn Fn(Vec3) -> Vec3| {
            let seen = rows.row(i).iter().map(|j| of(light[j as usize].into()));
            seen.sum::<Vec3>() * shares[i]
        };
        (mean(&|r| r * r) - mean(&|r| r).powf(2.0)).max(Vec3::ZERO)
    };
    let error: Vec<Vec3> = (0..n)
        .map(|j| reflectance[j] * reflectance[j] * variance(j) * 2.0 / samples)
        .collect();
    let columns = Transpose::of(&rows);
    let of_column = |j: usize| {
        let factors = &columns.factor[columns.start[j]..columns.start[j + 1]];
        error[j].element_sum() * factors.iter().map(|f| f * f).sum::<f32>()
    };
    ((0..n).map(of_column).sum::<f32>() / (3 * n) as f32).sqrt()
}

/// Through the program: the same files with one thread and with two, previews among them, memory in the report and in the
/// table, and nothing asked in a frame in which nothing moves.
#[test]
fn the_program_holds_less() {
    let case = case(&moving());
    let folder = case.folder.path();
    let render = |name: &str, threads: &str, more: &[&str]| {
        let output = format!("{name}/l_####.png");
        let args = ["--memory", "low", "--preview", "--frames", "0-1,8,9"];
        let args = [&args[..], &["--threads", threads, "-o", &output], more].concat();
        let output = quick(&case, "render", &args);
        done(&output);
        stdout(&output)
    };
    let report: Value = serde_json::from_str(&render("a", "1", &["--json"])).expect("JSON");
    let table = render("b", "2", &[]);
    let mut names: Vec<_> = fs::read_dir(folder.join("a")).expect("a folder").collect();
    assert!(names.len() > 10, "{} files", names.len());
    for name in names.drain(..) {
        let name = name.expect("a file").file_name();
        let [one, two] = ["a", "b"].map(|f| fs::read(folder.join(f).join(&name)).expect("a file"));
        assert!(one == two, "{name:?} depends on threads");
    }
    assert_eq!(report["settings"]["memory"], "low");
    assert_eq!(report["settings"]["solver"], "progressive");
    let [held, full] = ["memory_bytes", "memory_full_bytes"]
        .map(|name| report["scene"][name].as_u64().expect("bytes"));
    assert!(held < full, "{held} of {full} bytes");
    assert!(table.contains("every frame traces all samples") && table.contains("Memory: "));
    // The last two frames lie after the end of the animation: they hold its last pose.
    let frames = report["frames"].as_array().expect("frames");
    assert_eq!(frames[1]["traced"], frames[1]["samples"]);
    assert_eq!(
        (&frames[3]["traced"], &frames[3]["shots"]),
        (&0.into(), &0.into())
    );

    // With answers kept the report says twice what is held.
    let output = quick(&case, "render", &["--frames", "0", "--json", "-o", "f.png"]);
    let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let scene = &report["scene"];
    assert_eq!(scene["memory_bytes"], scene["memory_full_bytes"]);
    assert_eq!(report["settings"]["memory"], "full");
    // What they would take at least is not more than what they take.
    assert!(full <= scene["memory_bytes"].as_u64().expect("bytes"));
}

/// `verify` has nothing to compare, a page says so, and gathering needs rows.
#[test]
fn what_needs_kept_answers_is_refused() {
    let case = case(&moving());
    let told = quick(&case, "verify", &["--memory", "low"]);
    refused(&told, 2, &["--memory low", "leave --memory out", " — "]);
    let both = ["--memory", "low", "--solver", "gather"];
    refused(
        &quick(&case, "render", &both),
        2,
        &["--memory low", "--solver gather", " — "],
    );
    let page = [
        "--memory", "low", "--frames", "0-2", "-o", "x.png", "--report", "x.html",
    ];
    done(&quick(&case, "render", &page));
    let page = fs::read_to_string(case.folder.path().join("x.html")).expect("a page");
    assert!(
        page.contains("held, without hit ids") && page.contains("at least with all hit ids kept")
    );
}
