use super::*;

fn entry(file: &str, fingerprint: &str, bytes: &[u8]) -> FileRecord {
    FileRecord {
        file: file.into(),
        frame: 1,
        fingerprint: fingerprint.into(),
        blake3: checksum(bytes),
    }
}

#[test]
fn a_manifest_knows_what_is_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let mut one = Manifest::read(folder.path(), "a", None);
    one.hold().expect("a lock");
    let told = Manifest::read(folder.path(), "a", None).hold();
    assert!(told.is_err_and(|told| told.to_string().contains("another run writes")));
    let part = Some(Shard { part: 2, parts: 8 });
    let mut two = Manifest::read(folder.path(), "a", part);
    two.hold().expect("a lock of its own");
    fs::write(at("a_0001.png"), "one").expect("a file");
    fs::write(at("a_0002.png"), "two").expect("a file");
    one.add(&entry("a_0001.png", "f", b"one")).expect("a line");
    two.add(&entry("a_0002.png", "f", b"two")).expect("a line");
    drop((one, two));
    // A killed run leaves half a line.
    let mut cut = File::options()
        .append(true)
        .open(at("a.manifest.jsonl"))
        .expect("a file");
    cut.write_all(b"{\"file\": \"a_0003.p")
        .expect("half a line");
    let mut again = Manifest::read(folder.path(), "a", None);
    again.hold().expect("a lock");
    fs::write(at("a_0003.png"), "three").expect("a file");
    again
        .add(&entry("a_0003.png", "f", b"three"))
        .expect("a line");
    fs::write(at("a_0002.png"), "tw0").expect("a file");
    fs::write(at("a_0004.png"), "four").expect("a file");
    let known = Manifest::read(folder.path(), "a", None);
    let state = |file: &str, fingerprint: &str| known.state(&at(file), fingerprint);
    assert_eq!(state("a_0001.png", "f"), FileState::UpToDate);
    assert_eq!(state("a_0001.png", "g"), FileState::Stale);
    assert_eq!(state("a_0002.png", "f"), FileState::Damaged);
    assert_eq!(state("a_0003.png", "f"), FileState::UpToDate);
    assert_eq!(state("a_0004.png", "f"), FileState::Stale);
    assert_eq!(state("a_0005.png", "f"), FileState::Missing);
    assert_eq!(known.records().len(), 3);
}

#[test]
fn runs_with_claims_share_what_one_without_holds_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let claiming = |host| Manifest::read_claiming(folder.path(), "a", host);
    let (mut one, mut two) = (claiming("here"), claiming("the.re/"));
    one.share().expect("a lock");
    two.share().expect("a lock");
    let mut alone = Manifest::read(folder.path(), "a", None);
    let told = alone.hold().expect_err("shared").to_string();
    assert!(told.contains("with --claim"), "{told}");
    fs::write(folder.path().join("a_0001.png"), "one").expect("a file");
    one.add(&entry("a_0001.png", "f", b"one")).expect("a line");
    two.read_again();
    let state = two.state(&folder.path().join("a_0001.png"), "f");
    assert_eq!(state, FileState::UpToDate);
    drop((one, two));
    alone.hold().expect("a lock");
    let told = claiming("here").share().expect_err("held").to_string();
    assert!(told.contains("another run writes these frames"), "{told}");
    let all = Manifest::read(folder.path(), "a", None);
    assert_eq!(all.records().len(), 1);
}
