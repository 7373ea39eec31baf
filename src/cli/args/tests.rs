use super::*;
use crate::settings::{
    Aov, Choice, Curve, Exposure, Focus, HemisphereSampling, LightUnits, Memory, Meshing, OpenLens,
    Pairs, PixelFilter, PngBits, Quality, SkyChoice, Solver,
};

/// What a line means.
fn read(line: &str) -> Result<Command, Refusal> {
    let args = ["sweeplight"].into_iter().chain(line.split_whitespace());
    parse(args.map(OsString::from))
}

/// The refusal of a line: exit code and text.
fn told(line: &str) -> (u8, String) {
    match read(line) {
        Ok(command) => (255, format!("accepted as {command:?}")),
        Err(refusal) => (refusal.exit_code(), refusal.to_string()),
    }
}

#[test]
fn clap_takes_the_definition() {
    use clap::CommandFactory;
    CommandLine::command().debug_assert();
}

#[test]
fn render_takes_every_flag() {
    let line = "render a.glb -o x.png --output y_%04d.exr --frames 0-4x2,9 --fps 30 --size 320x180 --camera Top \
                --animation 1 --scene night --hide sky --hide tree --quality fine --element-size 0.5 --mesh adaptive --samples 64 --light-samples 8 --pixel-samples 9 \
                --sky 1,2,3 --sun -90,10,5 --light-units blender --light-scale 2 --emission-scale 0.5 \
                --pairs near --solver progressive --shots 700 --preview --form-factors plane \
                --exposure -1.5 --tone agx --png-bits 16 --aov depth,normal --filter gaussian --filter-radius 2 --f-stop 2.8 --focus Door \
                --threads 3 --memory 2.5 --from-scratch --report r.json --report r.html --json --quiet --exr-float";
    let Ok(Command::Render(settings, answer)) = read(line) else {
        panic!("{:?}", told(line))
    };
    assert_eq!(settings.scene.file, Path::new("a.glb"));
    assert_eq!(settings.output.images, ["x.png", "y_%04d.exr"]);
    assert_eq!(settings.scene.frames, Some(vec![0, 2, 4, 9]));
    assert_eq!(
        (settings.scene.fps, settings.image.size),
        (30.0, (320, 180))
    );
    assert_eq!(settings.scene.camera, Choice::Named("Top".into()));
    assert_eq!(settings.scene.animation, Choice::Named("1".into()));
    assert_eq!(settings.scene.stage, Choice::Named("night".into()));
    assert_eq!(settings.scene.hide, ["sky", "tree"]);
    assert_eq!(
        (
            settings.solve.quality,
            settings.solve.element_size,
            settings.solve.mesh
        ),
        (Quality::Fine, Some(0.5), Meshing::Adaptive)
    );
    assert_eq!(
        (
            settings.solve.samples,
            settings.solve.light_samples,
            settings.image.pixel_samples
        ),
        (Some(64), 8, 9)
    );
    assert_eq!(settings.light.sky, Some(SkyChoice::Even([1.0, 2.0, 3.0])));
    assert_eq!(settings.light.sun.map(|sun| sun.azimuth), Some(-90.0));
    assert_eq!(
        (
            settings.light.units,
            settings.light.scale,
            settings.light.emission_scale
        ),
        (LightUnits::Blender, 2.0, 0.5)
    );
    assert_eq!(
        (
            settings.solve.solver,
            settings.solve.shots,
            settings.output.preview
        ),
        (Solver::Progressive, Some(700), true)
    );
    assert_eq!(
        (settings.solve.memory, settings.solve.pairs),
        (Memory::Full, Pairs::Near)
    );
    assert_eq!(settings.solve.form_factors, HemisphereSampling::Plane);
    assert_eq!(settings.solve.memory_limit, Some(2_500_000_000));
    assert_eq!(
        (settings.image.exposure, settings.solve.threads),
        (Exposure::Stops(-1.5), Some(3))
    );
    assert_eq!(
        (settings.film.tone, settings.film.png_bits),
        (Curve::Agx, PngBits::Sixteen)
    );
    assert_eq!(settings.film.aovs, [Aov::Normal, Aov::Depth]);
    assert_eq!(
        (settings.film.filter, settings.film.filter_radius),
        (PixelFilter::Gaussian, 2.0)
    );
    let focus = Focus::Node("Door".into());
    assert_eq!(settings.film.lens, Some(OpenLens { f_stop: 2.8, focus }));
    assert_eq!(
        settings.output.reports,
        [Path::new("r.json"), Path::new("r.html")]
    );
    assert!(
        settings.solve.from_scratch && settings.output.exr_float && answer.json && answer.quiet
    );
}

#[test]
fn without_kept_answers_light_is_shot() {
    let Ok(Command::Render(settings, ..)) = read("render a.glb --memory low --shots 3 --memory 2")
    else {
        panic!("{:?}", told("render a.glb --memory low --shots 3"))
    };
    assert_eq!(settings.solve.solver, Solver::Progressive);
    assert_eq!(
        (settings.solve.memory, settings.solve.shots),
        (Memory::Low, Some(3))
    );
    assert_eq!(settings.solve.memory_limit, Some(2_000_000_000));
}

#[test]
fn what_is_not_said_is_the_default() {
    let (Ok(Command::Render(settings, ..)), defaults) =
        (read("render a.glb"), Settings::new("a.glb"))
    else {
        panic!("{:?}", told("render a.glb"))
    };
    assert_eq!(settings, defaults);
}

#[test]
fn verify_and_info_take_only_what_concerns_them() {
    let cube = "verify a.glb --form-factors hemicube --hemicube-resolution 8";
    assert!(
        matches!(read(cube), Ok(Command::Verify(settings, ..)) if settings.solve.hemicube_resolution == Some(8))
    );
    let verify = "verify a.glb --frames 3 --fps 12 --camera 0 --quality draft --samples 32 --threads 1 \
                  --shutter 1 --sub-frames 4";
    let Ok(Command::Verify(settings, ..)) = read(verify) else {
        panic!("{:?}", told(verify))
    };
    let film = (settings.film.shutter, settings.film.moments());
    assert_eq!((settings.solve.samples, film), (Some(32), (1.0, 4)));
    let info =
        "info a.glb --camera 0 --animation walk --fps 12 --quality draft --element-size 1 --json";
    assert!(matches!(read(info), Ok(Command::Info(_, answer)) if answer.json));
    for line in [
        "verify a.glb -o x.png",
        "info a.glb --frames 3",
        "verify",
        "info",
    ] {
        assert_eq!(told(line).0, 2, "{line}");
    }
}

#[test]
fn edit_takes_a_file_or_a_pipe() {
    let line = "edit a.glb --edits - -o x_####.png --budget 2.5 --play --verify --quality draft --size 32x18 --json";
    let Ok(Command::Edit(settings, edits, answer)) = read(line) else {
        panic!("{:?}", told(line))
    };
    assert!(edits.is_pipe() && edits.play && edits.verify && answer.json);
    assert_eq!((edits.budget, settings.image.size), (Some(2.5), (32, 18)));
    for (line, word) in [
        ("edit a.glb", "--edits"),
        ("edit a.glb --edits e --frames 3", "--frames"),
        ("edit a.glb --edits e --budget -1", "write e.g. --budget 5"),
        (
            "edit a.glb --edits e --mesh adaptive",
            "--mesh: expected uniform",
        ),
    ] {
        let (code, text) = told(line);
        assert!(code == 2 && text.contains(word), "{line}: {text}");
    }
}

/// Flags of `render` that edits take, and what shows it: the settings are others.
const HONOURED: [&str; 37] = [
    "--allow-external",
    "--elements 500",
    "--scene 1",
    "--camera Top",
    "--walk 5",
    "--sides both",
    "--light none",
    "--animation walk",
    "--hide sky",
    "--fps 12 --play",
    "--quality draft",
    "--element-size 0.5",
    "--samples 64",
    "--light-samples 8",
    "--sky 1,2,3",
    "--sun 0,45,5",
    "--light-units blender",
    "--light-scale 2",
    "--emission-scale 2",
    "--threads 1",
    "--memory 2",
    "--filter gaussian",
    "--filter-radius 2 --filter gaussian",
    "--f-stop 2 --focus 1",
    "--focus chair --f-stop 2",
    "--size 32x18",
    "--pixel-samples 9",
    "--finish gather",
    "--finish-samples 16",
    "--shading flat",
    "--exposure 1",
    "--tone agx",
    "--png-bits 16",
    "--output x_####.exr",
    "--exr-float -o x.exr",
    "--json",
    "--quiet",
];

/// Those that edits refuse, each with words of the refusal.
const REFUSED: [(&str, &str); 33] = [
    ("--dry-run", "unexpected argument '--dry-run'"),
    ("--profile", "unexpected argument '--profile'"),
    ("--progress json", "unexpected argument '--progress'"),
    ("--overwrite", "unexpected argument '--overwrite'"),
    ("--keep-existing", "unexpected argument '--keep-existing'"),
    ("--shard 1/2", "unexpected argument '--shard'"),
    ("--claim", "unexpected argument '--claim'"),
    ("--cache c", "unexpected argument '--cache'"),
    ("--mesh adaptive", "--mesh: expected uniform"),
    ("--mesh shadows", "--mesh: expected uniform"),
    ("--direct exact", "--direct: expected sampled"),
    ("--patch-elements 4", "--patch-elements: expected 1"),
    ("--frames 3", "unexpected argument '--frames'"),
    ("--from-scratch", "unexpected argument '--from-scratch'"),
    ("--shots 5", "unexpected argument '--shots'"),
    ("--preview", "unexpected argument '--preview'"),
    ("--no-ambient", "unexpected argument '--no-ambient'"),
    ("--aov all", "unexpected argument '--aov'"),
    ("--report r.json", "unexpected argument '--report'"),
    ("--solver gather", "--solver: expected none"),
    ("--solver progressive", "--solver: expected none"),
    ("--form-factors plane", "--form-factors: expected cosine"),
    ("--form-factors disks", "--form-factors: expected cosine"),
    (
        "--hemicube-resolution 8 --form-factors hemicube",
        "--form-factors: expected cosine",
    ),
    ("--pairs near", "--pairs: expected none"),
    ("--memory low", "--memory low: expected gigabytes"),
    ("--light-samples 65", "from 1 to 64"),
    ("--finish phong", "--finish: expected a finish"),
    ("--fps 12", "--fps: expected --play"),
    ("--shutter 0.5", "--shutter: expected 0"),
    ("--sub-frames 4 --shutter 0.5", "--shutter: expected 0"),
    ("--exr-float", "ends in .exr"),
    ("-o x.mp4", "-o: expected a picture for each step"),
];

#[test]
fn edits_honour_each_flag_of_render_or_refuse_it() {
    let base = "edit a.glb --edits e";
    let settings = |line: &str| match read(line) {
        Ok(Command::Edit(settings, edits, answer)) => format!("{settings:?} {edits:?} {answer:?}"),
        _ => panic!("{line}: {:?}", told(line)),
    };
    let plain = settings(base);
    for flag in HONOURED {
        assert_ne!(settings(&format!("{base} {flag}")), plain, "{flag}");
    }
    for (flag, words) in REFUSED {
        let (code, text) = told(&format!("{base} {flag}"));
        assert!(code == 2 && text.contains(words), "{flag}: {text}");
    }
    for name in ["x.gif", "x.apng", "x.png -o y.mp4"] {
        assert_eq!(told(&format!("{base} -o {name}")).0, 2, "{name}");
    }
    // No flag of render is missing from the tables.
    use clap::CommandFactory;
    let line = CommandLine::command();
    let render = line.find_subcommand("render").expect("the command");
    let known = HONOURED.into_iter().chain(REFUSED.map(|(flag, _)| flag));
    let known: Vec<&str> = known.filter_map(|flag| flag.split(' ').next()).collect();
    for flag in render.get_arguments().filter_map(|arg| arg.get_long()) {
        assert!(known.contains(&format!("--{flag}").as_str()), "--{flag}");
    }
}

#[test]
fn validate_is_the_table_a_race_or_the_slopes() {
    for (line, expected) in [
        ("validate", Trial::Answers),
        ("validate --slalom --json", Trial::Race(60.0)),
        ("validate --slalom 2.5", Trial::Race(2.5)),
        (
            "validate --compare a.glb --elements 50",
            Trial::Compare("a.glb".into(), Some(50)),
        ),
        ("validate --convergence", Trial::Convergence(Vec::new())),
        (
            "validate --convergence --report a.html",
            Trial::Convergence(vec!["a.html".into()]),
        ),
    ] {
        assert!(
            matches!(read(line), Ok(Command::Validate(trial, _)) if trial == expected),
            "{line}"
        );
    }
    for line in [
        "validate --slalom 0",
        "validate --slalom -1",
        "validate --slalom x",
    ] {
        let (code, text) = told(line);
        assert!(
            code == 2 && text.contains("write e.g. --slalom 60"),
            "{text}"
        );
    }
    assert_eq!(told("validate --slalom --convergence").0, 2);
    assert_eq!(told("validate --report a.html").0, 2);
}

#[test]
fn without_a_scene_the_default_is_looked_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = |line: &[&str]| parse_in(folder.path(), line.iter().map(OsString::from));
    let missing = read(&["sweeplight"]).expect_err("no scene").to_string();
    assert!(
        missing.ends_with("name a scene: sweeplight render SCENE.glb"),
        "{missing}"
    );

    let scene = folder.path().join(DEFAULT_SCENE);
    std::fs::create_dir(folder.path().join("animations")).expect("a folder");
    std::fs::write(&scene, "").expect("a file");
    for line in [
        &["sweeplight"][..],
        &["sweeplight", "render", "--quality", "draft"],
    ] {
        assert!(
            matches!(read(line), Ok(Command::Render(settings, ..)) if settings.scene.file == scene)
        );
    }
}

#[test]
fn refusals_name_the_way_out() {
    for (line, code, word) in [
        ("--help", 0, "exit-codes"),
        ("render --help", 0, "Frame n shows time n/fps"),
        ("--version", 0, env!("CARGO_PKG_VERSION")),
        ("render a.glb --fps 0", 2, "write e.g. --fps 24"),
        ("render a.glb --fps -1", 2, "got '-1'"),
        ("render a.glb --frames -4", 2, "got '-4'"),
        (
            "render a.glb --samples 100",
            2,
            "the nearest is --samples 96",
        ),
        (
            "render a.glb -o x.tif",
            2,
            ".png (sRGB), .exr (linear radiance), .mp4, .gif or .apng",
        ),
        (
            "render a.glb --exr-float",
            2,
            "add -o 'frames/name_####.exr'",
        ),
        (
            "render a.glb --finish smooth",
            2,
            "hybrid, gather, points, flat or phong",
        ),
        (
            "verify a.glb --finish-samples 12",
            2,
            "the nearest is --finish-samples 16",
        ),
        ("render a.glb --f-stop 2", 2, "add e.g. --focus 2.5"),
        ("verify a.glb --focus 2", 2, "add e.g. --f-stop 2.8"),
        ("render a.glb --filter-radius 2", 2, "add --filter gaussian"),
        ("render a.glb --sub-frames 4", 2, "add e.g. --shutter 0.5"),
        (
            "render a.glb --solver progressive --preview --shutter 0.5",
            2,
            "leave --preview or --shutter out",
        ),
        (
            "render a.glb --aov depth",
            2,
            "add -o 'frames/name_####.exr'",
        ),
        ("render a.glb --preview", 2, "add --solver progressive"),
        ("render a.glb --shots 9", 2, "--shots: expected a solver"),
        (
            "render a.glb --solver progressive --shots -1",
            2,
            "a whole number from 0, got '-1'",
        ),
        ("render a.glb --memory 4G", 2, "or low, got '4G'"),
        (
            "render a.glb --memory low --solver gather",
            2,
            "--memory low: expected --solver progressive",
        ),
        (
            "render a.glb --memory low --pairs near",
            2,
            "--memory low: expected --pairs none",
        ),
        ("verify a.glb --pairs all", 2, "none or near, got 'all'"),
        (
            "verify a.glb --solver jacobi",
            2,
            "gather or progressive, got 'jacobi'",
        ),
        (
            "render a.glb --form-factors cube",
            2,
            "cosine, hemicube, plane, contour or disks, got 'cube'",
        ),
        (
            "verify a.glb --hemicube-resolution 32",
            2,
            "add --form-factors hemicube",
        ),
        (
            "render a.glb --form-factors hemicube --hemicube-resolution 33",
            2,
            "the nearest is --hemicube-resolution 34",
        ),
        (
            "render a.glb --form-factors hemicube --hemicube-resolution 32 --samples 64",
            2,
            "cannot be used with",
        ),
        ("render a.glb --nonsense", 2, "--nonsense"),
        ("a.glb", 2, "write sweeplight render a.glb"),
        ("nonsense", 2, "nonsense"),
    ] {
        let (got, text) = told(line);
        assert!(got == code && text.contains(word), "{line}: {got}: {text}");
    }
}

/// Each default stands in the settings and is told in the help: a flag with the value told changes nothing.
#[test]
fn defaults_told_are_those_used() {
    use clap::CommandFactory;
    let base = "render a.glb --solver progressive --form-factors hemicube --shutter 0.5 --filter gaussian -o x.exr";
    let plain = match read(base) {
        Ok(Command::Render(settings, _)) => settings,
        _ => panic!("{:?}", told(base)),
    };
    let line = CommandLine::command();
    let render = line.find_subcommand("render").expect("the command");
    let mut checked = 0;
    for arg in render.get_arguments() {
        let help = arg.get_long_help().or(arg.get_help());
        let help = help.map(ToString::to_string).unwrap_or_default();
        let default = help
            .rsplit_once("[default: ")
            .and_then(|(_, rest)| rest.split_once(']'));
        let (Some(flag), Some((default, _))) = (arg.get_long(), default) else {
            continue;
        };
        // Defaults in words are none that can be typed, and these four stand in the base.
        let set = ["solver", "form-factors", "shutter", "filter", "output"].contains(&flag);
        if set || default.contains(' ') || default == "black" {
            continue;
        }
        let typed = format!("{base} --{flag} {default}");
        match read(&typed) {
            Ok(Command::Render(settings, _)) => assert_eq!(settings, plain, "{typed}"),
            _ => panic!("{:?}", told(&typed)),
        }
        checked += 1;
    }
    assert!(checked > 12, "{checked} defaults");
}
