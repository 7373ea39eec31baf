//! Memory as the system tells it: what the machine has, and the most that this process held.

/// Physical memory taken for granted where the system does not tell it.
const USUAL_MEMORY: u64 = 16_000_000_000;

/// The machine's memory in bytes.
pub(crate) fn memory() -> u64 {
    told("/proc/meminfo", "MemTotal:").unwrap_or(USUAL_MEMORY)
}

/// The most bytes of memory that this process has held so far.
pub(super) fn peak() -> Option<u64> {
    told("/proc/self/status", "VmHWM:")
}

/// A line of kilobytes in a file of the system, in bytes.
fn told(file: &str, name: &str) -> Option<u64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(kilobytes.saturating_mul(1024))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_holds_less_than_the_machine_has() {
        assert!(memory() > 100_000_000);
        if let Some(peak) = peak() {
            assert!((1_000_000..memory()).contains(&peak), "{peak}");
        }
    }
}
