//! What camera and film make of the light: tone, exposure, layers, filters, lens and shutter, through the program.

use crate::support::program::{done, moving, quick, refused};
use crate::support::run::{Case, case};
use crate::support::scene::{Scene, Shape, block, room};
use exr::prelude::{AttributeValue, ReadChannels, ReadLayers, Text, read};
use glam::Vec3;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use sweeplight::image::film::Image;
use sweeplight::settings::{Focus, OpenLens, PixelFilter};

/// A PNG's pixels, and the bits of its channels.
fn png(case: &Case, name: &str) -> (Vec<u8>, png::BitDepth) {
    let file = fs::File::open(case.folder.path().join(name)).expect(name);
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let mut reader = decoder.read_info().expect("a header");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut pixels).expect("pixels");
    (pixels, reader.info().bit_depth)
}

/// Each flag refuses what it does not know, by its name and with a way out, before anything is rendered.
#[test]
fn bad_values_are_refused_by_name() {
    let case = case(&moving());
    fs::write(case.folder.path().join("bad.txt"), "0 1\n1 bright\n").expect("a file");
    for (code, args, words) in [
        (2, ["--tone", "filmic"], &["none, neutral or agx"][..]),
        (2, ["--png-bits", "12"], &["8 or 16"]),
        (2, ["--exposure", "99"], &["stops from -32 to 32"]),
        (
            2,
            ["--exposure", "bad.txt"],
            &["'1 bright' in bad.txt, line 2"],
        ),
        (3, ["--exposure", "none.txt"], &["none.txt", "FRAME STOPS"]),
        (2, ["--aov", "depth"], &["an output that ends in .exr"]),
        (2, ["--filter", "mitchell"], &["box or gaussian"]),
        (2, ["--filter-radius", "0"], &["pixels from 0.1 to 16"]),
        (2, ["--f-stop", "f/2"], &["a number from 0.01 to 1000"]),
        (2, ["--focus", "-1"], &["metres from 0.01"]),
        (2, ["--shutter", "180"], &["from 0 to 1"]),
        (2, ["--sub-frames", "1"], &["the nearest is --sub-frames 2"]),
    ] {
        let told = quick(&case, "render", &["--frames", "0", args[0], args[1]]);
        refused(&told, code, words);
        refused(&told, code, &[" — "]);
    }
    let lost = ["--frames", "0", "--f-stop", "2", "--focus", "nobody"];
    refused(
        &quick(&case, "render", &lost),
        2,
        &["--focus", "'nobody'", " — "],
    );
    let colour = ["--frames", "0", "-o", "x.exr", "--aov", "colour"];
    refused(
        &quick(&case, "render", &colour),
        2,
        &["--aov", "all, or some of"],
    );
    let mut flat = moving();
    flat.flat_camera(Vec3::new(1.5, 1.0, 1.2), Vec3::ZERO, 1.2);
    flat.save(case.folder.path(), "scene.gltf");
    let flat = ["--camera", "1", "--f-stop", "2", "--focus", "2"];
    refused(
        &quick(&case, "render", &flat),
        2,
        &["--f-stop", "orthographic camera", " — "],
    );
    assert!(!case.folder.path().join("frames").exists());
}

/// A file of exposures gives each frame the picture that its stops alone would give.
#[test]
fn exposures_of_a_file_are_those_of_the_flag() {
    let case = case(&moving());
    fs::write(case.folder.path().join("e.txt"), "0 -1\n4 1\n").expect("a file");
    let args = [
        "--frames",
        "0,3",
        "--exposure",
        "e.txt",
        "-o",
        "file_####.png",
    ];
    done(&quick(&case, "render", &args));
    // Three quarters of the way from −1 to 1 are half a stop.
    for (stops, frame) in [("-1", "0"), ("0.5", "3")] {
        let output = format!("at{stops}_####.png");
        let args = ["--frames", "0,3", "--exposure", stops, "-o", &output];
        done(&quick(&case, "render", &args));
        let (file, flag) = (
            format!("file_000{frame}.png"),
            format!("at{stops}_000{frame}.png"),
        );
        assert_eq!(png(&case, &file), png(&case, &flag));
    }
    assert_ne!(png(&case, "file_0000.png"), png(&case, "at0.5_0000.png"));
}

/// The same light through each curve, in 8 and 16 bits: the upper byte of 16 bits is within a code of 8 bits.
#[test]
fn curves_differ_and_depths_agree() {
    let case = case(&moving());
    let mut seen = Vec::new();
    for tone in ["none", "neutral", "agx"] {
        let [few, many] = ["8", "16"].map(|bits| {
            let name = format!("{tone}{bits}_####.png");
            let args = [
                "--frames",
                "0",
                "--tone",
                tone,
                "--png-bits",
                bits,
                "-o",
                &name,
            ];
            done(&quick(&case, "render", &args));
            png(&case, &name.replace("####", "0000"))
        });
        assert_eq!(
            (few.1, many.1),
            (png::BitDepth::Eight, png::BitDepth::Sixteen)
        );
        for (code, fine) in few.0.iter().zip(many.0.chunks(2)) {
            let fine = f64::from(u16::from_be_bytes([fine[0], fine[1]])) / 257.0;
            assert!((f64::from(*code) - fine).abs() <= 0.51, "{code}, {fine}");
        }
        assert!(!seen.contains(&few.0), "{tone} is another curve");
        seen.push(few.0);
    }
}

/// An EXR's channels by name, and its rate and notes.
fn exr(
    case: &Case,
    name: &str,
) -> (
    BTreeMap<String, Vec<f32>>,
    exr::meta::header::LayerAttributes,
) {
    let reader = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels();
    let path = case.folder.path().join(name);
    let reader = reader.first_valid_layer().all_attributes();
    let layer = reader.from_file(path).expect(name).layer_data;
    let channels = layer.channel_data.list.iter().map(|channel| {
        let values = channel.sample_data.values_as_f32().collect();
        (channel.name.to_string(), values)
    });
    (channels.collect(), layer.attributes)
}

/// Emission, direct and indirect light add up to the picture, pixel by pixel; the other layers say what is there.
#[test]
fn layers_add_up_and_tell_what_is_there() {
    let case = case(&moving());
    let args = [
        "--frames",
        "0,4",
        "-o",
        "x_####.exr",
        "--exr-float",
        "--aov",
        "all",
    ];
    done(&quick(&case, "render", &args));
    let (channels, attributes) = exr(&case, "x_0004.exr");
    assert_eq!(channels.len(), 3 + 5 * 3 + 2 * 3 + 1 + 1 + 1 + 2);
    for channel in ["R", "G", "B"] {
        let part = |layer: &str| &channels[&format!("{layer}.{channel}")];
        let (emission, direct, indirect) = (part("emission"), part("direct"), part("indirect"));
        assert!(
            direct.iter().any(|light| *light > 0.0) && indirect.iter().any(|light| *light > 0.0)
        );
        for (at, all) in channels[channel].iter().enumerate() {
            assert_eq!(emission[at] + direct[at] + indirect[at], *all, "pixel {at}");
            assert_eq!(part("specular")[at], 0.0, "no mirror at pixel {at}");
        }
    }
    // The camera is in a closed room: everywhere something is seen, and its normal is at most a unit long.
    let value = |name: &str, at: usize| channels[name][at];
    for at in 0..32 * 18 {
        for layer in ["normal", "truenormal"] {
            let normal = ["X", "Y", "Z"].map(|axis| value(&format!("{layer}.{axis}"), at));
            let length = Vec3::from(normal).length();
            assert!((0.2..=1.000_01).contains(&length), "{layer}: {normal:?}");
        }
        assert!((0.0..10.0).contains(&value("depth.Z", at)));
        let patch = value("patch.X", at);
        assert!(patch >= -1.0 && patch.fract() == 0.0);
        let share = value("recomputed.Y", at);
        assert!((0.0..=1.0).contains(&share) && (0.0..=1.0).contains(&value("albedo.R", at)));
    }
    let of = |name: &str, value: f32| channels[name].iter().filter(|v| **v == value).count();
    // The block moved: some pixels were asked again and others not; the first frame asked all of them.
    assert!(of("recomputed.X", 1.0) > 0 && of("recomputed.X", 0.0) > 0);
    assert_eq!(of("recomputed.X", 1.0) + of("recomputed.X", 0.0), 32 * 18);
    let first = exr(&case, "x_0000.exr").0;
    assert!(
        first["recomputed.X"]
            .iter()
            .chain(&first["recomputed.Y"])
            .all(|v| *v == 1.0)
    );
    let mut objects = channels["object.X"].clone();
    objects.sort_by(f32::total_cmp);
    objects.dedup();
    assert!(objects.len() >= 2, "room, lamp or block: {objects:?}");
    // What the file says of itself.
    assert_eq!(attributes.frames_per_second, Some((8, 1)));
    let note = |name: &str| match attributes.other.get(&Text::from(name)) {
        Some(AttributeValue::Text(text)) => text.to_string(),
        other => panic!("{name}: {other:?}"),
    };
    assert_eq!(
        (note("Frame"), note("Time")),
        ("4".into(), "0.500000 s".into())
    );
    assert!(note("Scene").ends_with("scene.gltf") && note("Software").starts_with("sweeplight "));
    let settings: serde_json::Value = serde_json::from_str(&note("Settings")).expect("JSON");
    assert_eq!(
        (&settings["samples"], settings.get("threads")),
        (&32.into(), None)
    );
}

/// A parent that stands after its children in the file comes before them in the scene; layers count as the file does.
#[test]
fn objects_are_numbered_as_in_the_file() {
    let mut scene = passing();
    let grey = scene.material(Vec3::splat(0.5), Vec3::ZERO);
    let near = scene.object("near", &Shape::solid(Vec3::splat(0.3)), grey);
    scene.group("parent", &[near]);
    let case = case(&scene);
    let args = ["--frames", "0", "-o", "x.exr", "--aov", "object"];
    done(&quick(&case, "render", &args));
    let seen = &exr(&case, "x.exr").0["object.X"];
    assert!(seen.contains(&(near as f32)), "no {near} in {seen:?}");
    assert!(
        !seen.contains(&(near as f32 + 1.0)),
        "the parent has no shape"
    );
}

/// A room in which a block passes before a resting camera, from 0 to 1 s.
fn passing() -> Scene {
    let mut scene = room();
    let block = block(&mut scene, "block", Vec3::splat(0.2));
    let places = [Vec3::new(-0.5, 0.1, 0.3), Vec3::new(0.5, -0.2, -0.4)];
    scene.slide(block, "LINEAR", &[(0.0, places[0]), (0.5, places[1])]);
    scene
}

fn images(case: &Case) -> Vec<Image> {
    let mut images = Vec::new();
    case.walk(&case.prepare(), |_, _, image| images.push(image.clone()));
    images
}

/// A Gaussian and a lens keep what pixels saw as a box and a pinhole do: exactly, and only where nothing moved.
#[test]
fn a_filter_and_a_lens_reuse_pixels_exactly() {
    let mut case = case(&passing());
    let sharp = images(&case);
    case.settings.film.filter = PixelFilter::Gaussian;
    case.settings.film.filter_radius = 2.0;
    let soft = images(&case);
    let focus = Focus::Node("block".into());
    case.settings.film.lens = Some(OpenLens { f_stop: 0.1, focus });
    case.exact();
    case.settings.film.lens = Some(OpenLens {
        f_stop: 0.1,
        focus: Focus::Metres(2.0),
    });
    case.exact();
    let asked = case.reports().into_iter().map(|r| r.pixels_traced);
    assert!(asked.skip(1).all(|asked| asked < 48 * 27 && asked > 0));
    // Both are other pictures of the same light: their means agree to a few per cent.
    let mean = |image: &Image| {
        let all = image.radiance.as_flattened();
        all.iter().sum::<f32>() / all.len() as f32
    };
    let blurred = images(&case);
    for other in [&soft[0], &blurred[0]] {
        assert_ne!(other, &sharp[0]);
        let ratio = mean(other) / mean(&sharp[0]);
        assert!((0.95..1.05).contains(&ratio), "{ratio}");
    }
}

/// An open shutter: exact in every moment, and the picture of a frame is the mean of the pictures of its moments.
#[test]
fn a_shutter_is_the_mean_of_its_moments() {
    let mut case = case(&passing());
    case.settings.film.shutter = 1.0;
    case.settings.film.sub_frames = 4;
    case.settings.scene.frames = Some(vec![1, 2]);
    let verified = case.exact();
    assert_eq!(verified.frames, 8);
    // Frame 1 at 8 frames a second: 1/8 s ± 3/64 and ± 1/64 s, which are frames 5, 7, 9 and 11 at 64 frames a second.
    let args = [
        "--frames",
        "1",
        "--shutter",
        "1",
        "--sub-frames",
        "4",
        "-o",
        "blur_####.exr",
    ];
    done(&quick(
        &case,
        "render",
        &[&args[..], &["--exr-float"]].concat(),
    ));
    let args = [
        "--frames",
        "5-11x2",
        "--fps",
        "64",
        "-o",
        "one_####.exr",
        "--exr-float",
    ];
    let size = ["--samples", "32", "--element-size", "1", "--size", "32x18"];
    let all = [&["render", "scene.gltf"][..], &size, &args].concat();
    done(&crate::support::program::sweeplight(
        case.folder.path(),
        &all,
    ));
    let blurred = exr(&case, "blur_0001.exr").0;
    let moments = ["0005", "0007", "0009", "0011"].map(|n| exr(&case, &format!("one_{n}.exr")).0);
    for channel in ["R", "G", "B"] {
        for (at, got) in blurred[channel].iter().enumerate() {
            let sum: f64 = moments.iter().map(|m| f64::from(m[channel][at])).sum();
            assert_eq!(*got, (sum / 4.0) as f32, "pixel {at}");
        }
    }
    assert_ne!(moments[0]["R"], moments[3]["R"]);
}

/// Where nothing moves, an open shutter and an open lens change nothing from frame to frame.
#[test]
fn what_stands_still_stays_still() {
    let case = case(&room());
    let lens = ["--f-stop", "0.5", "--focus", "1.5"];
    let args = ["--frames", "0-2", "-o", "x_####.exr", "--shutter", "0.5"];
    done(&quick(&case, "render", &[&args[..], &lens].concat()));
    let frames = [0, 1, 2].map(|n| exr(&case, &format!("x_000{n}.exr")).0);
    assert!(frames[0] == frames[1] && frames[1] == frames[2]);
    let args = ["--frames", "0", "-o", "y_####.exr"];
    done(&quick(&case, "render", &[&args[..], &lens].concat()));
    assert!(
        exr(&case, "y_0000.exr").0 == frames[0],
        "a mean of equal pictures is the picture"
    );
}

/// Runs the program with these folders as its PATH.
fn quick_in(case: &Case, path: &Path, args: &[&str]) -> Output {
    let all = [
        "render",
        "scene.gltf",
        "--samples",
        "32",
        "--element-size",
        "1",
        "--fps",
        "8",
    ];
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
    command.args(all).args(["--size", "31x18"]).args(args);
    let output = command
        .current_dir(case.folder.path())
        .env("PATH", path)
        .output();
    output.expect("the program starts")
}

/// The colours of each frame of an animated PNG, painted over those before, and how long each is shown.
fn animated(case: &Case, name: &str) -> Vec<(Vec<u8>, f64)> {
    let file = fs::File::open(case.folder.path().join(name)).expect(name);
    let mut reader = png::Decoder::new(std::io::BufReader::new(file))
        .read_info()
        .expect("a header");
    let frames = reader
        .info()
        .animation_control
        .expect("an animation")
        .num_frames;
    let width = reader.info().width as usize;
    let mut canvas = vec![0; reader.output_buffer_size().expect("a size")];
    let mut shown = Vec::new();
    for _ in 0..frames {
        let mut part = vec![0; canvas.len()];
        reader.next_frame(&mut part).expect("a frame");
        let at = *reader.info().frame_control.as_ref().expect("a frame");
        let row = at.width as usize * 3;
        for y in 0..at.height as usize {
            let to = ((y + at.y_offset as usize) * width + at.x_offset as usize) * 3;
            canvas[to..to + row].copy_from_slice(&part[y * row..(y + 1) * row]);
        }
        shown.push((
            canvas.clone(),
            f64::from(at.delay_num) / f64::from(at.delay_den),
        ));
    }
    shown
}

/// A name without a number is one file: a picture of one frame, an animated PNG of more, with the pixels of the sequence.
#[test]
fn one_name_is_one_file() {
    let case = case(&moving());
    let there = |name: &str| case.folder.path().join(name).exists();
    let args = [
        "--frames",
        "0-6x2",
        "-o",
        "x.png",
        "-o",
        "x_####.png",
        "-o",
        "x.gif",
    ];
    done(&quick(&case, "render", &args));
    assert!(
        !there("x.png.frames") && !there("x.gif.frames"),
        "stills are gone"
    );
    let shown = animated(&case, "x.png");
    assert_eq!(shown.len(), 4);
    for (number, (pixels, seconds)) in shown.iter().enumerate() {
        assert!(
            *pixels == png(&case, &format!("x_000{}.png", 2 * number)).0,
            "frame {number}"
        );
        // Every second frame of eight a second: a quarter of a second each.
        assert_eq!(*seconds, 0.25);
    }
    let gif = fs::File::open(case.folder.path().join("x.gif")).expect("a GIF");
    let mut gif = gif::DecodeOptions::new().read_info(gif).expect("a header");
    assert_eq!((gif.width(), gif.height()), (32, 18));
    let mut delays = Vec::new();
    while let Some(frame) = gif.read_next_frame().expect("a frame") {
        delays.push(frame.delay);
    }
    assert_eq!(delays, [25; 4]);
    done(&quick(
        &case,
        "render",
        &["--frames", "3", "-o", "one.png", "-o", "one.exr"],
    ));
    assert!(there("one.png") && there("one.exr") && !there("one_0003.png"));
}

/// Without ffmpeg a video is refused before any work; with one, it is given every still, the rate, and a place to write.
#[cfg(unix)]
#[test]
fn videos_go_through_ffmpeg() {
    use std::os::unix::fs::PermissionsExt;
    let case = case(&moving());
    let folder = case.folder.path();
    let (nothing, bin) = (folder.join("nothing"), folder.join("bin"));
    fs::create_dir(&nothing).expect("a folder");
    fs::create_dir(&bin).expect("a folder");
    let args = ["--frames", "0-2", "-o", "x.mp4"];
    let told = quick_in(&case, &nothing, &args);
    refused(
        &told,
        6,
        &["x.mp4", "ffmpeg is not installed", "-o out.gif", " — "],
    );
    assert!(
        !folder.join("x.mp4.frames").exists(),
        "refused before the work"
    );

    // One that writes down what it is told, and takes what it is given for the video.
    let install = |script: &str| {
        fs::write(bin.join("ffmpeg"), script).expect("a file");
        fs::set_permissions(bin.join("ffmpeg"), fs::Permissions::from_mode(0o755)).expect("a mode");
    };
    install(
        "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\necho \"$@\" > said\nfor last; do :; done\nexec /bin/cat > \"$last\"\n",
    );
    done(&quick_in(
        &case,
        &bin,
        &[&args[..], &["-o", "y_####.png"]].concat(),
    ));
    let said = fs::read_to_string(folder.join("said")).expect("what it was told");
    for word in [
        "-framerate 8/1",
        "-c:v png -framerate",
        "libx264",
        "yuv420p",
        "-f mp4",
    ] {
        assert!(said.contains(word), "'{word}' is not in: {said}");
    }
    let stills =
        [0, 1, 2].map(|n| fs::read(folder.join(format!("y_000{n}.png"))).expect("a still"));
    assert!(fs::read(folder.join("x.mp4")).expect("a video") == stills.concat());
    assert!(!folder.join("x.mp4.frames").exists());

    // One that fails: what it says is told, and no frame is lost.
    install("#!/bin/sh\n[ \"$1\" = -version ] && exit 0\necho no encoder >&2\nexit 1\n");
    let told = quick_in(&case, &bin, &["--frames", "0-2", "-o", "z.mp4"]);
    refused(
        &told,
        6,
        &[
            "z.mp4",
            "ffmpeg: no encoder",
            "all frames are in z.mp4.frames",
            " — ",
        ],
    );
    let kept = fs::read(folder.join("z.mp4.frames/0002.png")).expect("a frame");
    assert!(kept == stills[2] && !folder.join("z.mp4").exists());
}
