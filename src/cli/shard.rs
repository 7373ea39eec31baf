//! `--shard`: the part of the frames, as typed or as a Slurm array or GNU parallel numbers its jobs.

use crate::cli::values::{read, usage};
use crate::error::{Error, Result};
use crate::settings::Shard;

/// Reads `2/8`, `auto` or `auto/8`.
pub(super) fn parse(flag: &str, text: &str) -> Result<Shard> {
    of(flag, text, &|name| {
        std::env::var(name).ok().and_then(|value| read(&value))
    })
}

/// The same in any environment.
fn of(flag: &str, text: &str, environment: &dyn Fn(&str) -> Option<u32>) -> Result<Shard> {
    let (part, parts) = match text.split_once('/') {
        Some(("auto", parts)) => (parallel(flag, environment)?, read(parts)),
        Some((part, parts)) => (read(part), read(parts)),
        None if text == "auto" => slurm(flag, environment)?,
        None => (None, None),
    };
    let shard = part.zip(parts).map(|(part, parts)| Shard { part, parts });
    shard
        .filter(|shard| (1..=shard.parts).contains(&shard.part))
        .ok_or_else(|| {
            let expected = "a part and the number of parts, from 1, such as 2/8, or auto";
            usage(flag, expected, text, "write e.g. --shard 2/8")
        })
}

/// The number of a job of GNU parallel, from 1.
fn parallel(flag: &str, environment: &dyn Fn(&str) -> Option<u32>) -> Result<Option<u32>> {
    match environment("PARALLEL_SEQ") {
        None => Err(missing(flag, "PARALLEL_SEQ, which GNU parallel sets")),
        part => Ok(part),
    }
}

/// The place of a task in its Slurm array, from 1, and the number of tasks.
fn slurm(
    flag: &str,
    environment: &dyn Fn(&str) -> Option<u32>,
) -> Result<(Option<u32>, Option<u32>)> {
    let of = |name: &str| environment(&format!("SLURM_ARRAY_TASK_{name}"));
    let (Some(id), Some(first), Some(count)) = (of("ID"), of("MIN"), of("COUNT")) else {
        let name = "SLURM_ARRAY_TASK_ID, _MIN and _COUNT, which a Slurm array sets";
        return Err(missing(flag, name));
    };
    let step = of("STEP").unwrap_or(1).max(1);
    Ok((Some(id.saturating_sub(first) / step + 1), Some(count)))
}

fn missing(flag: &str, name: &str) -> Error {
    usage(
        flag,
        name,
        "an environment without",
        "write the part itself, e.g. --shard 2/8, or auto/8 in a job of GNU parallel",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shard(text: &str, environment: &[(&str, u32)]) -> std::result::Result<(u32, u32), String> {
        let find = |name: &str| environment.iter().find(|(known, _)| *known == name);
        let shard = of("--shard", text, &|name| find(name).map(|(_, value)| *value));
        shard
            .map(|shard| (shard.part, shard.parts))
            .map_err(|told| told.to_string())
    }

    #[test]
    fn parts_are_typed_or_the_farm_s_own() {
        assert_eq!(shard("2/8", &[]), Ok((2, 8)));
        let array = |id| {
            [
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_MIN", 0),
                ("SLURM_ARRAY_TASK_COUNT", 4),
            ]
        };
        assert_eq!(shard("auto", &array(0)), Ok((1, 4)));
        assert_eq!(shard("auto", &array(3)), Ok((4, 4)));
        assert_eq!(shard("auto/3", &[("PARALLEL_SEQ", 2)]), Ok((2, 3)));
        for wrong in ["0/8", "9/8", "x/8", "8", "1/0", "auto/0", "auto", "-1/2"] {
            let told = shard(wrong, &[]).expect_err(wrong);
            assert!(told.starts_with("--shard: expected "), "{told}");
        }
    }
}
