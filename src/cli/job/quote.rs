//! Words as a shell reads them: each argument stays one argument, whatever it contains.

/// An argument for a POSIX shell: as it is where no character has a meaning, else in single quotes.
pub(super) fn shell(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "_@%+=:,./-".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        return word.into();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// Several arguments, with spaces in between.
pub(super) fn words(words: &[String]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| shell(word)).collect();
    quoted.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_keep_their_borders() {
        for (word, quoted) in [
            ("frames/x_0001.png", "frames/x_0001.png"),
            ("--exposure=-1.5", "--exposure=-1.5"),
            ("", "''"),
            ("x_####.png", "'x_####.png'"),
            ("it's", r"'it'\''s'"),
            ("$HOME `id` \\ \"*\"", "'$HOME `id` \\ \"*\"'"),
            ("ü\n{1..2}", "'ü\n{1..2}'"),
            ("~", "'~'"),
        ] {
            assert_eq!(shell(word), quoted);
        }
        assert_eq!(words(&["a b".into(), "c".into()]), "'a b' c");
    }

    /// A real shell gives back what was quoted.
    #[cfg(unix)]
    #[test]
    fn a_shell_reads_what_was_written() {
        let odd = [
            "",
            "a b",
            "it's",
            "''",
            "$HOME;#!\\",
            "\"*\"\t?\n[x]",
            "-n",
            "=~^",
        ];
        let odd = odd.map(String::from);
        let script = format!("printf '%s\\0' {}", words(&odd));
        let output = std::process::Command::new("sh")
            .args(["-c", &script])
            .output();
        let printed = output.expect("a shell").stdout;
        let expected: String = odd.iter().map(|word| format!("{word}\0")).collect();
        assert_eq!(String::from_utf8(printed).expect("UTF-8"), expected);
    }
}
