use super::*;

/// The refusal of a value, as told.
fn told<T>(result: Result<T>) -> String {
    result
        .err()
        .map_or("accepted".into(), |error| error.to_string())
}

#[test]
fn rates() {
    assert_eq!(fps("23.976").ok(), Some(23.976));
    assert_eq!(fps("1000").ok(), Some(1000.0));
    for text in ["0", "-1", "NaN", "inf", "1000.1", "abc", ""] {
        assert!(
            told(fps(text)).starts_with("--fps: expected frames per second above 0"),
            "{text}"
        );
    }
}

#[test]
fn sizes() {
    assert_eq!(size("640x360").ok(), Some((640, 360)));
    assert_eq!(size("1X16384").ok(), Some((1, 16_384)));
    for text in [
        "640",
        "0x360",
        "640x",
        "640x16385",
        "640x360x2",
        "-1x1",
        "99999999999x1",
    ] {
        assert!(
            told(size(text)).contains("each 1 to 16384, got '"),
            "{text}"
        );
    }
}

#[test]
fn the_nearest_count_is_the_way_out() {
    assert_eq!(samples("4096").ok(), Some(4096));
    assert_eq!(
        told(samples("0")),
        "--samples: expected a whole number from 16 to 4096, got '0' — the nearest is --samples 16"
    );
    assert!(told(samples("100")).ends_with("the nearest is --samples 96"));
    assert!(told(samples("4090")).ends_with("the nearest is --samples 4096"));
    assert!(told(samples("9999999999")).ends_with("the nearest is --samples 4096"));
    assert!(told(samples("many")).ends_with("write e.g. --samples 16"));
    assert_eq!(light_samples("1").ok(), Some(1));
    assert!(told(light_samples("1025")).ends_with("the nearest is --light-samples 1024"));
    let squares = (1..=64).filter(|count: &u32| pixel_samples(&count.to_string()).is_ok());
    assert_eq!(squares.collect::<Vec<_>>(), [1, 4, 9, 16, 25, 36, 49, 64]);
    assert!(told(pixel_samples("8")).ends_with("the nearest is --pixel-samples 9"));
    assert!(told(threads("0")).ends_with("the nearest is --threads 1"));
}

#[test]
fn lengths() {
    assert_eq!(element_size("0.25").ok(), Some(0.25));
    assert!(
        ["0", "-1", "inf", "nan", "1m"]
            .iter()
            .all(|text| element_size(text).is_err())
    );
}

#[test]
fn meshes() {
    assert_eq!(elements("1").ok(), Some(1));
    assert_eq!(elements("16777215").ok(), Some(16_777_215));
    for text in ["0", "16777216", "-3", "1e4", "few"] {
        assert!(told(elements(text)).starts_with("--elements"), "{text}");
    }
    assert_eq!(mesh("adaptive").ok(), Some(Mesh::Adaptive));
    assert_eq!(mesh("uniform").ok(), Some(Mesh::Uniform));
    assert!(told(mesh("fine")).contains("expected uniform or adaptive, got 'fine'"));
}

#[test]
fn sets_of_samples() {
    assert_eq!(form_factors("plane").ok(), Some(FormFactors::Plane));
    let told_of = told(form_factors("cube"));
    assert!(
        told_of.contains("expected cosine, hemicube or plane, got 'cube'"),
        "{told_of}"
    );
    assert_eq!(hemicube_resolution("32").ok(), Some(32));
    for (text, way_out) in [
        ("9", "the nearest is --hemicube-resolution 10"),
        ("512", "the nearest is --hemicube-resolution 146"),
        ("0", "the nearest is --hemicube-resolution 4"),
        ("-4", "write e.g. --hemicube-resolution 32"),
        ("many", "write e.g. --hemicube-resolution 32"),
    ] {
        let told = told(hemicube_resolution(text));
        assert!(told.ends_with(way_out), "{text}: {told}");
    }
}

#[test]
fn presets() {
    assert_eq!(quality("fine").ok(), Some(Quality::Fine));
    assert!(told(quality("high")).contains("expected draft, standard or fine, got 'high'"));
}

#[test]
fn no_file_is_written_twice() {
    let texts = |texts: &[&str]| {
        texts
            .iter()
            .map(|text| text.to_string())
            .collect::<Vec<_>>()
    };
    assert_eq!(
        outputs(&texts(&["a.png", "a.exr"])).ok(),
        Some(vec![Kind::Png, Kind::Exr])
    );
    for clash in [
        ["a_%04d.png", "a_####.png"],
        ["a", "a_####.png"],
        ["a.exr", "a_####.exr"],
    ] {
        assert!(
            told(outputs(&texts(&clash))).contains(" twice"),
            "{clash:?}"
        );
    }
    assert!(outputs(&texts(&["a.png", "a_####.png", "a.gif", "a.apng"])).is_ok());
    assert!(told(outputs(&texts(&["a.tif"]))).starts_with("-o: "));
}
