use clap::{Arg, Command};

use super::*;

/// The value that a parser makes of a text behind a flag, or its refusal.
fn parse<P: TypedValueParser>(
    parser: P,
    flag: &'static str,
    text: &str,
) -> std::result::Result<P::Value, String> {
    let arg = Arg::new(flag).long(flag);
    let parsed = parser.parse_ref(&Command::new("test"), Some(&arg), OsStr::new(text));
    parsed.map_err(|error| error.to_string())
}

#[test]
fn sizes() {
    assert_eq!(size("--size", "640x360").ok(), Some((640, 360)));
    assert_eq!(size("--size", "1X16384").ok(), Some((1, 16_384)));
    for text in [
        "640",
        "0x360",
        "640x",
        "640x16385",
        "640x360x2",
        "-1x1",
        "99999999999x1",
    ] {
        let told = size("--size", text).expect_err("refused").to_string();
        assert!(told.contains("each 1 to 16384, got '"), "{text}: {told}");
    }
}

#[test]
fn the_nearest_count_is_the_way_out() {
    let samples = |text: &str| {
        let sixteens = |count| (count + 8) / 16 * 16;
        parse(
            series((16, 4096), "a multiple of 16", sixteens),
            "samples",
            text,
        )
    };
    assert_eq!(samples("4096"), Ok(4096));
    assert_eq!(
        samples("0"),
        Err("error: --samples: expected a whole number from 16 to 4096, got '0' — the nearest is --samples 16\n".into())
    );
    for (text, nearest) in [("100", 96), ("4090", 4096), ("9999999999", 4096)] {
        let way_out = format!("the nearest is --samples {nearest}\n");
        assert!(
            samples(text).is_err_and(|told| told.ends_with(&way_out)),
            "{text}"
        );
    }
    assert!(samples("many").is_err_and(|told| told.ends_with("write e.g. --samples 16\n")));
    let squares = |count: &u32| square(*count) == *count;
    let squares: Vec<u32> = (1..=64).filter(squares).collect();
    assert_eq!(squares, [1, 4, 9, 16, 25, 36, 49, 64]);
}

#[test]
fn numbers_fit_or_are_refused_with_an_example() {
    let rate = |text: &str| {
        let fits = |rate: &f64| *rate > 0.0 && *rate <= 1000.0;
        parse(number("a rate above 0", fits, "24"), "fps", text)
    };
    assert_eq!((rate("23.976"), rate("1000")), (Ok(23.976), Ok(1000.0)));
    for text in ["0", "-1", "NaN", "inf", "1000.1", "abc", ""] {
        let told =
            format!("error: --fps: expected a rate above 0, got '{text}' — write e.g. --fps 24\n");
        assert_eq!(rate(text), Err(told));
    }
}

#[test]
fn names_are_listed() {
    use crate::settings::HemisphereSampling;
    let set = |text: &str| {
        parse(
            one_of::<HemisphereSampling>("leave it out"),
            "form-factors",
            text,
        )
    };
    assert_eq!(set("plane"), Ok(HemisphereSampling::Plane));
    let told = "error: --form-factors: expected cosine, hemicube, plane, contour or disks, got 'cube' — leave it out\n";
    assert_eq!(set("cube"), Err(told.into()));
}

#[test]
fn no_file_is_written_twice() {
    let outputs = |texts: &[&str]| {
        let texts: Vec<String> = texts.iter().map(ToString::to_string).collect();
        outputs(&texts)
    };
    assert_eq!(
        outputs(&["a.png", "a.exr"]).ok(),
        Some(vec![FileKind::Png, FileKind::Exr])
    );
    for clash in [
        ["a_%04d.png", "a_####.png"],
        ["a", "a_####.png"],
        ["a.exr", "a_####.exr"],
    ] {
        let told = outputs(&clash).expect_err("refused").to_string();
        assert!(told.contains(" twice"), "{told}");
    }
    assert!(outputs(&["a.png", "a_####.png", "a.gif", "a.apng"]).is_ok());
    assert!(outputs(&["a.tif"]).is_err_and(|error| error.to_string().starts_with("-o: ")));
}
