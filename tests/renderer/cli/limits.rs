//! Limits of what a scene may ask: the same for all commands, and told before the work.

use crate::support::program::{done, moving, quick, refused, stderr, stdout, sweeplight};
use crate::support::run::{Case, case};
use crate::support::scene::{self, Scene};
use glam::Vec3;
use serde_json::{Value, json};
use std::fs;
use std::io::Write;
use std::process::{Command, Output, Stdio};

/// The scene of a case, its JSON changed.
fn changed(case: &Case, name: &str, change: impl FnOnce(&mut Value)) {
    let path = case.folder.path().join("scene.gltf");
    let mut json: Value = serde_json::from_slice(&fs::read(path).expect("a file")).expect("JSON");
    change(&mut json);
    fs::write(case.folder.path().join(name), json.to_string()).expect("a file");
}

/// A session on a scene that is given these lines.
fn edited(case: &Case, scene: &str, lines: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweeplight"));
    command.args([
        "edit",
        scene,
        "--edits=-",
        "--samples=32",
        "--element-size=1",
        "--size=32x18",
    ]);
    command
        .current_dir(case.folder.path())
        .stdin(Stdio::piped());
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a start");
    // A session that is refused reads no line.
    let _ = child
        .stdin
        .take()
        .expect("a pipe")
        .write_all(lines.as_bytes());
    child.wait_with_output().expect("an end")
}

/// What is too far away is refused by every command in the same words, and so is what an edit adds.
#[test]
fn coordinates_have_one_bound() {
    let case = case(&moving());
    let words = ["far.gltf: node 'block'", "coordinates below 1e15 metres"];
    for (place, fits) in [
        (9.9e14, true),
        (1.1e15, false),
        (1e20, false),
        (1e30, false),
        (1e38, false),
    ] {
        changed(&case, "far.gltf", |json| {
            let node = json["nodes"]
                .as_array_mut()
                .expect("nodes")
                .iter_mut()
                .find(|node| node["name"] == "block");
            node.expect("a block")["translation"] = json!([place, 0, 0]);
            json["animations"] = json!([]);
        });
        let folder = case.folder.path();
        let info = sweeplight(folder, &["info", "far.gltf"]);
        if fits {
            done(&info);
            continue;
        }
        refused(&info, 4, &words);
        for command in ["render", "verify"] {
            refused(
                &sweeplight(folder, &[command, "far.gltf", "--frames", "0"]),
                4,
                &words,
            );
        }
        refused(&edited(&case, "far.gltf", ""), 4, &words);
        let added = edited(
            &case,
            "scene.gltf",
            "{\"edits\":[{\"add\":{\"file\":\"far.gltf\"}}]}\n{}\n",
        );
        done(&added);
        let told = stdout(&added);
        let lines: Vec<&str> = told.lines().collect();
        assert!(lines.len() == 3 && lines[1].contains(words[1]), "{told}");
    }
}

/// Emission beyond the bound is refused by material or by flag; below it every pixel is a number.
#[test]
fn emission_has_a_bound() {
    let case = case(&moving());
    let folder = case.folder.path();
    let quick = |scene: &str, args: &[&str]| {
        let small = [
            "--frames=0",
            "--samples=32",
            "--element-size=1",
            "--size=32x18",
            "-o",
            "y.exr",
        ];
        sweeplight(folder, &[&["render", scene], &small[..], args].concat())
    };
    for strength in ["1e12", "1e30", "3e38"] {
        changed(&case, "bright.gltf", |json| {
            let lit = |material: &&mut Value| material["emissiveFactor"] != json!([0.0, 0.0, 0.0]);
            let lamp = json["materials"]
                .as_array_mut()
                .expect("materials")
                .iter_mut()
                .find(lit);
            let lamp = lamp.expect("a lamp");
            lamp["name"] = json!("lamp");
            lamp["emissiveFactor"] = json!([1, 1, 1]);
            let strength: f64 = strength.parse().expect("a number");
            lamp["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] =
                json!(strength);
        });
        let rendered = quick("bright.gltf", &[]);
        if strength == "1e12" {
            done(&rendered);
            let image = exr::prelude::read_first_flat_layer_from_file(folder.join("y.exr"));
            let channels = image.expect("an EXR").layer_data.channel_data.list;
            let mut values = channels.iter().flat_map(|c| c.sample_data.values_as_f32());
            assert!(values.all(f32::is_finite));
            done(&sweeplight(
                folder,
                &[
                    "verify",
                    "bright.gltf",
                    "--frames=0",
                    "--samples=32",
                    "--element-size=1",
                ],
            ));
        } else {
            refused(
                &rendered,
                4,
                &["material 'lamp'", "from 0 to 1e12 W/(m²·sr)", " — lower it"],
            );
        }
    }
    refused(
        &quick("scene.gltf", &["--emission-scale", "1e30"]),
        4,
        &["from 0 to 1e12", "--emission-scale"],
    );
    refused(&quick("scene.gltf", &["--sun", "0,45,1e30"]), 2, &["--sun"]);
    refused(&quick("scene.gltf", &["--sky", "1e30,0,0"]), 2, &["--sky"]);
    let bright =
        "{\"edits\":[{\"emission\":{\"material\":\"material 1\",\"strength\":1e30}}]}\n{}\n";
    let told = edited(&case, "scene.gltf", bright);
    done(&told);
    let told = stdout(&told);
    assert!(
        told.lines()
            .nth(1)
            .is_some_and(|line| line.contains("from 0 to 1e12")),
        "{told}"
    );
    assert!(
        told.lines().count() == 3 && !told.contains("null"),
        "{told}"
    );
}

/// What is no glTF is named by its kind; nothing of what it says is printed.
#[test]
fn a_file_that_is_no_gltf_is_named_by_its_kind() {
    let folder = tempfile::tempdir().expect("a folder");
    for (bytes, kind) in [
        (&b"\x89PNG\r\n\x1a\nsecret"[..], "a PNG picture"),
        (b"PK\x03\x04secret", "a ZIP archive"),
        (b"BLENDER-v405secret", "a Blender file"),
        (b"Kaydara FBX Binary secret", "an FBX file"),
        (b"# secret\nv 0 0 0\n", "an OBJ file"),
        (b"\x1f\x8bsecret", "compressed by gzip"),
        (b"secret=1", "text of another kind"),
    ] {
        fs::write(folder.path().join("a.glb"), bytes).expect("a file");
        for command in ["info", "render", "verify"] {
            let told = sweeplight(folder.path(), &[command, "a.glb"]);
            refused(&told, 4, &["a.glb", kind]);
            assert!(!stderr(&told).contains("secret"), "{}", stderr(&told));
        }
    }
}

/// Pictures that state more than fits are refused before they are decoded.
#[test]
fn the_size_of_a_picture_is_judged_before_it_is_decoded() {
    let case = case(&moving());
    let folder = case.folder.path();
    done(&quick(&case, "render", &["--frames", "0", "-o", "sky.exr"]));
    let mut sky = fs::read(folder.join("sky.exr")).expect("an EXR");
    for name in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let at = sky
            .windows(name.len())
            .position(|bytes| bytes == name.as_bytes());
        // A box is two corners, both inside, behind its length.
        let last = at.expect("an attribute") + name.len() + 4 + 8;
        for axis in [last, last + 4] {
            sky[axis..axis + 4].copy_from_slice(&16_382_i32.to_le_bytes());
        }
    }
    fs::write(folder.join("huge.exr"), &sky).expect("a file");
    let told = quick(&case, "render", &["--sky", "huge.exr"]);
    refused(&told, 2, &["--sky", "too few for the 1024 blocks"]);
    let told = quick(&case, "render", &["--sky", "huge.exr", "--memory", "1"]);
    refused(
        &told,
        2,
        &[
            "--sky",
            "268402689 texels, of which 25000000 fit into the memory",
        ],
    );
    fs::write(
        folder.join("huge.hdr"),
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 20000\n",
    )
    .expect("a file");
    let told = quick(&case, "render", &["--sky", "huge.hdr", "--memory", "1"]);
    refused(&told, 2, &["--sky", "400000000 texels"]);

    // The header of a PNG of 8,000 × 8,000, and no pixel.
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x1f\x40\0\0\x1f\x40\x08\x06\0\0\0".to_vec();
    png.extend(crc32(&png[12..]).to_be_bytes());
    png.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    fs::write(folder.join("huge.png"), png).expect("a file");
    let mut painted = scene::room();
    let texture = painted.texture(&[vec![[255; 4]]], 10497);
    painted.edit(0)["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": texture});
    fs::write(folder.join("huge.gltf"), with_picture(&painted, "huge.png")).expect("a file");
    let args = ["render", "huge.gltf", "--memory", "1.5"];
    refused(
        &sweeplight(folder, &args),
        2,
        &["--memory", "64000000 pixels, 1.7 GB"],
    );
}

/// A scene whose only picture is another file.
fn with_picture(scene: &Scene, picture: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let text = fs::read(scene.save(folder.path(), "a.gltf")).expect("a file");
    let mut json: Value = serde_json::from_slice(&text).expect("JSON");
    json["images"][0] = json!({"uri": picture});
    // The first two coordinates of its corners are texture coordinates as well.
    let attributes = &mut json["meshes"][0]["primitives"][0]["attributes"];
    let corners = attributes["POSITION"].as_u64().expect("corners") as usize;
    let accessors = json["accessors"].as_array_mut().expect("accessors");
    let mut coordinates = accessors[corners].clone();
    coordinates["type"] = json!("VEC2");
    coordinates
        .as_object_mut()
        .expect("an accessor")
        .retain(|key, _| key != "min" && key != "max");
    accessors.push(coordinates);
    let number = accessors.len() - 1;
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(number);
    json.to_string()
}

/// The checksum of a PNG's chunk (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 * (crc & 1))
        })
    };
    !bytes.iter().fold(u32::MAX, step)
}

/// Files outside the scene's folder are read only where that is allowed.
#[test]
fn a_scene_reads_its_own_folder_alone() {
    let case = case(&moving());
    let folder = case.folder.path();
    fs::create_dir(folder.join("in")).expect("a folder");
    changed(&case, "in/scene.gltf", |json| {
        let buffer = &mut json["buffers"][0];
        let uri = buffer["uri"].as_str().expect("data").to_string();
        let digits = uri.split_once(',').expect("a comma").1.to_string();
        fs::write(folder.join("scene.txt"), digits).expect("a file");
        buffer["uri"] = json!("%2e%2e/scene.bin");
    });
    let length = fs::metadata(folder.join("scene.txt"))
        .expect("a file")
        .len();
    fs::write(folder.join("scene.bin"), vec![0; length as usize]).expect("a file");
    for command in ["info", "render", "verify"] {
        let told = sweeplight(folder, &[command, "in/scene.gltf"]);
        refused(
            &told,
            4,
            &[
                "/buffers/0/uri: expected a file inside the scene's folder",
                "--allow-external",
            ],
        );
    }
    // Allowed, it is read: all of its corners are zero.
    let told = sweeplight(folder, &["info", "in/scene.gltf", "--allow-external"]);
    assert!(
        !stderr(&told).contains("inside the scene's folder"),
        "{}",
        stderr(&told)
    );
}

/// Glass is named, and what becomes of its light.
#[test]
fn glass_that_is_simpler_here_is_told_by_name() {
    let mut scene = moving();
    let pane = scene.material(Vec3::splat(0.8), Vec3::ZERO);
    scene.edit(pane)["name"] = json!("pane");
    scene.edit(pane)["extensions"]["KHR_materials_transmission"] =
        json!({"transmissionFactor": 0.9});
    let veil = scene.material(Vec3::splat(0.8), Vec3::splat(2.0));
    scene.edit(veil)["name"] = json!("veil");
    scene.edit(veil)["alphaMode"] = json!("BLEND");
    scene.edit(veil)["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, 0.25]);
    for material in [pane, veil] {
        scene.object("sheet", &scene::Shape::solid(Vec3::splat(0.1)), material);
    }
    scene.used = vec!["KHR_materials_transmission"];
    let case = case(&scene);
    let told = stderr(&quick(&case, "render", &["--frames", "0"]));
    let rough = "material 'pane': rough glass in the file; here light passes it straight on, and it has no gloss — ";
    assert!(told.contains(&format!("warning: {rough}")), "{told}");
    assert!(
        told.contains(
            "warning: material 'veil': blended with an alpha below 0.5, and shines by itself or is unlit, so not there at all — "
        ),
        "{told}"
    );
    let info = stdout(&sweeplight(case.folder.path(), &["info", "scene.gltf"]));
    assert!(info.contains(rough), "{info}");
}

/// A picture is counted before it is made, and so is the light of many emitters; `info` says what a render will take.
#[test]
fn memory_is_counted_before_it_is_taken() {
    let case = case(&moving());
    let large = [
        "render",
        "scene.gltf",
        "--size",
        "16384x16384",
        "--memory",
        "20",
    ];
    let told = sweeplight(case.folder.path(), &large);
    // 16384² pixels of 1000 bytes and 4 samples of 20 each: 306.0 GB.
    let words = [
        "--memory: expected",
        "306.0 GB for a picture of 16384x16384 — a smaller --size",
    ];
    refused(&told, 2, &words);
    let small = [
        "render",
        "scene.gltf",
        "--memory",
        "0.001",
        "--size",
        "64x36",
        "--frames",
        "0",
    ];
    refused(
        &sweeplight(case.folder.path(), &small),
        2,
        &["--memory: expected a scene that fits into the 0.0 GB given"],
    );

    let mut crowd = scene::room();
    let lamp = crowd.material(Vec3::splat(0.5), Vec3::ONE);
    for at in 0..400 {
        let node = crowd.object("lamp", &scene::Shape::solid(Vec3::splat(0.01)), lamp);
        let place = Vec3::new((at % 20) as f32, 0.0, (at / 20) as f32);
        let place = 0.05 * place - Vec3::new(0.5, 0.0, 0.5);
        crowd.set(node, "translation", json!(place.to_array()));
    }
    crowd.save(case.folder.path(), "crowd.gltf");
    let info = |scene: &str| -> Value {
        let output = sweeplight(case.folder.path(), &["info", scene, "--json"]);
        done(&output);
        serde_json::from_str(&stdout(&output)).expect("JSON")
    };
    let [one, many] = ["scene.gltf", "crowd.gltf"].map(info);
    for info in [&one, &many] {
        let key = |key: &str| info[key].as_f64().expect("a number");
        assert!(
            key("samples") > key("elements") && key("memory_bytes") > 1e6,
            "{info}"
        );
        assert!(info["seconds"][0].as_f64() > Some(0.0), "{info}");
    }
    // Each of some ten thousand sides keeps twelve bytes of each of 401 emitters.
    let bytes = |info: &Value| info["memory_bytes"].as_f64().expect("bytes");
    let sides = many["elements"].as_f64().expect("elements");
    assert!(bytes(&many) > 12.0 * 401.0 * sides, "{many}");
}
