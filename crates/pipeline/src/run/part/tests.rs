use super::*;

fn shard(text: &str, variables: &[(&str, &str)]) -> Result<Shard, PartError> {
    let variable = |name: &str| variables.iter().find(|(n, _)| *n == name).map(|(_, value)| (*value).to_owned());
    text.parse::<Part>().expect("a part").shard(&variable)
}

#[test]
fn an_explicit_index_wins_over_the_scheduler() {
    let set = [("SLURM_ARRAY_TASK_ID", "7")];
    assert_eq!(shard("3/8", &set), Ok(Shard { index: 3, count: 8 }));
    assert_eq!(shard("/8", &set), Ok(Shard { index: 8, count: 8 }));
}

#[test]
fn every_scheduler_counts_from_0() {
    for name in INDICES {
        assert_eq!(shard("/8", &[(name, "0")]), Ok(Shard { index: 1, count: 8 }), "{name}");
        assert_eq!(shard("/8", &[(name, "7")]), Ok(Shard { index: 8, count: 8 }), "{name}");
        for wrong in ["8", "-1", "", "x", "99999999999999999999"] {
            let error = PartError::OutOfRange { count: 8, name, found: wrong.to_owned() };
            assert_eq!(shard("/8", &[(name, wrong)]), Err(error), "{name}");
        }
    }
    assert_eq!(shard("/8", &[]), Err(PartError::NoIndex { count: 8 }));
}

#[test]
fn a_slurm_array_from_1_fails_in_every_task() {
    let task = |id, largest| shard("/8", &[("SLURM_ARRAY_TASK_ID", id), (LARGEST, largest)]);
    assert!(matches!(task("1", "8"), Err(PartError::OutOfRange { name: LARGEST, .. })));
    assert_eq!(task("3", "3"), Ok(Shard { index: 4, count: 8 }), "a task that is submitted again alone");
}

#[test]
fn rejects_malformed_parts() {
    for text in ["", "/", "0/2", "3/2", "/0", "2", "2/", "a/b", "-1/2", "1/2/3"] {
        assert!(text.parse::<Part>().is_err(), "{text:?}");
    }
}
