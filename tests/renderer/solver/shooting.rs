//! Progressive refinement in real scenes: the same light as gathering, pictures on the way there, and any number of shots.

use crate::support::program::{done, moving, quick, refused, stderr, stdout};
use crate::support::run::case;
use serde_json::Value;
use std::fs;
use std::path::Path;
use sweeplight::settings::Solver;
use sweeplight::settings::TOLERANCE;
use sweeplight::solver::{self, Radiosity, StopRule, System};
use sweeplight::visibility::MissIds;

/// Gathering, shooting from darkness and shooting from the light of the frame before agree to 1e-6 of the root mean square
/// on the rows of every frame, solved to a tenth of that.
#[test]
fn three_solves_of_every_frame_agree() {
    const TIGHT: f32 = 1e-7;
    let case = case(&moving());
    let prepared = case.prepare();
    let n = prepared.patches.sides.len();
    let element = |side: &sweeplight::mesh::Side| {
        (prepared.rest).area(&prepared.patches.elements[side.element])
    };
    let area: Vec<f32> = prepared.patches.sides.iter().map(element).collect();
    let reflectance = prepared.patches.reflectances(&prepared.rest);
    let mut last = Radiosity::default();
    case.walk_light(&prepared, |state, report| {
        let shares = prepared.back.shares(&state.view);
        let rows = prepared.rows(&state.view, &shares);
        let direct = state.view.direct();
        let given = System {
            area: &area,
            direct: &direct,
            reflectance: &reflectance,
        };
        let shoot = |start: &Radiosity| {
            let stop = StopRule::at(TIGHT);
            solver::shoot(&rows, given, MissIds::KINDS, start, stop, &mut |_, _| ())
        };
        let dark = shoot(&Radiosity::default());
        let incremental = shoot(&last);
        let gathered = solver::gather(
            &rows,
            &direct,
            &reflectance,
            MissIds::KINDS,
            Radiosity::default(),
            TIGHT,
        );
        let squares: f32 = dark.reflected.iter().map(|r| r.length_squared()).sum();
        let rms = (squares / (3 * n) as f32).sqrt();
        for (way, light) in [("gathered", &gathered), ("incremental", &incremental)] {
            let pairs = light.reflected.iter().zip(&dark.reflected);
            let most = pairs.map(|(a, b)| (*a - *b).abs().max_element());
            let off = most.fold(0.0, f32::max) / rms;
            assert!(off < 1e-6, "frame {}: {way}: {off:e}", report.frame);
        }
        assert!(dark.shots > n as u64 / 2);
        assert!(report.frame == 0 || incremental.shots < dark.shots);
        last = incremental;
    });
}

/// `verify` holds with shooting as it does with gathering, and both solvers end within twice the tolerance.
#[test]
fn verify_holds_with_either_solver() {
    let mut case = case(&moving());
    case.settings.solve.solver = Solver::Progressive;
    let verified = case.exact();
    assert_eq!(verified.allowed_difference, 2.0 * f64::from(TOLERANCE));
    assert!(verified.largest_difference > 0.0, "two solves, not one");
    let reports = case.reports();
    assert!(reports.iter().all(|r| r.sweeps == 0));
    assert!(reports.iter().all(|r| r.residual <= f64::from(TOLERANCE)));
    // The key frame of nine is the one in the middle: it has its light already.
    assert_eq!(reports[4].shots, 0);
    case.settings.solve.from_scratch = true;
    for (warm, cold) in reports.iter().zip(case.reports()) {
        assert!(warm.shots < cold.shots, "frame {}", warm.frame);
    }
}

fn pixels(folder: &Path, name: &str) -> Vec<u16> {
    let picture = image::open(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    picture.into_rgb16().into_raw()
}

/// Steps of a 16-bit picture that are one of an 8-bit picture.
const STEP: u16 = 257;

/// The largest difference of two pictures, in steps of 65,535: from a warm start not much is left to see in 255.
fn off(a: &[u16], b: &[u16]) -> u16 {
    let steps = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    steps.max().expect("pixels")
}

/// Through the program: a preview after each power of two of shots and no other, ever nearer to the picture, which is that
/// of gathering; all of it the same with one thread and with two.
#[test]
fn previews_lead_to_the_picture() {
    let case = case(&moving());
    let folder = case.folder.path();
    let args = |threads| {
        let name = if threads == "1" {
            "a/p_####.png"
        } else {
            "b/p_####.png"
        };
        [
            "--solver",
            "progressive",
            "--preview",
            "--frames",
            "0-1",
            "--json",
            "--png-bits",
            "16",
            "--threads",
            threads,
            "-o",
            name,
        ]
    };
    let output = quick(&case, "render", &args("1"));
    done(&output);
    let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(report["settings"]["solver"], "progressive");
    done(&quick(&case, "render", &args("2")));
    let gathered = ["--frames", "0-1", "--png-bits", "16", "-o", "g_####.png"];
    done(&quick(&case, "render", &gathered));

    // Expect these files, and compare them.
    let mut expected = Vec::new();
    for frame in 0..2 {
        let shots = report["frames"][frame]["shots"].as_u64().expect("shots");
        assert!(shots >= 64, "{shots} shots");
        let picture = pixels(folder, &format!("a/p_{frame:04}.png"));
        let from_gathering = off(&picture, &pixels(folder, &format!("g_{frame:04}.png")));
        assert!(from_gathering <= STEP, "{from_gathering} steps");
        let powers = (0..).map(|e| 1u64 << e).take_while(|power| *power <= shots);
        let names: Vec<String> = powers
            .map(|power| format!("p_{frame:04}_shots_{power:07}.png"))
            .collect();
        let away = |name: &String| off(&picture, &pixels(folder, &format!("a/{name}")));
        let (first, last) = (away(&names[0]), away(&names[names.len() - 1]));
        assert!(
            last <= first / 2,
            "{last} of {first} steps in frame {frame}"
        );
        expected.push(format!("p_{frame:04}.png"));
        expected.extend(names);
    }
    expected.push("p.manifest.jsonl".into());
    expected.sort();
    for written in ["a", "b"] {
        let entries = fs::read_dir(folder.join(written)).expect("a folder");
        let name =
            |entry: std::io::Result<fs::DirEntry>| entry.expect("a file").file_name().into_string();
        let mut names: Vec<String> = entries.map(|e| name(e).expect("UTF-8")).collect();
        names.sort();
        assert_eq!(names, expected);
    }
    for name in &expected {
        let [one, two] = ["a", "b"].map(|f| fs::read(folder.join(f).join(name)).expect("a file"));
        assert!(one == two, "{name} depends on threads");
    }
}

/// `--shots` ends a solve early, says in the report how far it is off, and is refused where nothing is shot.
#[test]
fn a_number_of_shots_ends_the_solve() {
    let case = case(&moving());
    let args = [
        "--solver",
        "progressive",
        "--shots",
        "9",
        "--frames",
        "0",
        "-o",
        "x_####.png",
    ];
    let output = quick(&case, "render", &[&args[..], &["--json"]].concat());
    done(&output);
    let report: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(report["frames"][0]["shots"], 9);
    assert_eq!(report["total"]["shots"], 9);
    let residual = report["frames"][0]["residual"].as_f64();
    assert!(residual.expect("a number") > f64::from(TOLERANCE));
    // The picture has the ambient term, and so is nearer to that of all shots.
    assert_eq!(report["frames"][0]["ambient"], true);
    let folder = case.folder.path();
    let mean = |name: &str| {
        let pixels = pixels(folder, name);
        pixels.iter().map(|p| f64::from(*p)).sum::<f64>() / pixels.len() as f64
    };
    let with = mean("x_0000.png");
    let bare = [
        &args[..6],
        &["--no-ambient", "-o", "bare_####.png", "--json"],
    ]
    .concat();
    let bare_report = quick(&case, "render", &bare);
    done(&bare_report);
    let bare_report: Value = serde_json::from_str(&stdout(&bare_report)).expect("JSON");
    assert_eq!(bare_report["frames"][0]["ambient"], false);
    let all = ["--frames", "0", "-o", "all_####.png"];
    done(&quick(&case, "render", &all));
    let (bare, all) = (mean("bare_0000.png"), mean("all_0000.png"));
    assert!(
        bare < with && (with - all).abs() < 0.5 * (bare - all).abs(),
        "{bare} {with} {all}"
    );
    let table = quick(&case, "render", &[&args[..], &["--overwrite"]].concat());
    let told = stdout(&table);
    assert!(told.contains("ambient term"), "{told}");
    assert!(
        told.contains("shots") && !told.contains("sweeps"),
        "{told}{}",
        stderr(&table)
    );
    for flags in [&["--preview"][..], &["--shots", "9"]] {
        let way_out = ["--solver progressive", flags[0], " — "];
        refused(&quick(&case, "render", flags), 2, &way_out);
    }
    let flags = ["--patch-elements", "4", "--solver", "progressive"];
    refused(
        &quick(&case, "render", &flags),
        2,
        &["--patch-elements: expected --solver gather"],
    );
    let flags = ["--patch-elements", "0"];
    refused(
        &quick(&case, "render", &flags),
        2,
        &["a whole number from 1 to 1024"],
    );
}
