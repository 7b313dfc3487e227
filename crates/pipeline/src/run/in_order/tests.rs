use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use rayon::prelude::*;

use super::*;

#[test]
fn takes_results_in_order_and_bounds_how_many_wait() {
    for workers in [0, 1, 2, 5] {
        let taken = AtomicUsize::new(0);
        let (mut found, most_ahead) = (Vec::new(), AtomicUsize::new(0));
        let make = |index: usize| {
            most_ahead.fetch_max(index - taken.load(Ordering::SeqCst).min(index), Ordering::SeqCst);
            thread::sleep(Duration::from_micros((index as u64 * 7919) % 300));
            index * 2
        };
        let ended = in_order(40, workers, make, |index, result| {
            found.push((index, result));
            taken.store(index, Ordering::SeqCst);
            Ok::<(), ()>(())
        });
        assert_eq!(ended, Ok(()));
        assert_eq!(found, (0..40).map(|i| (i, 2 * i)).collect::<Vec<_>>());
        assert!(most_ahead.load(Ordering::SeqCst) <= 2 * workers.max(1));
    }
    assert_eq!(in_order(0, 2, |_| (), |_, ()| Err("never called")), Ok(()));
}

#[test]
fn an_error_of_take_ends_the_map() {
    let made = AtomicUsize::new(0);
    let make = |index| {
        made.fetch_add(1, Ordering::SeqCst);
        index
    };
    assert_eq!(in_order(1000, 2, make, |index, _| if index == 5 { Err(index) } else { Ok(()) }), Err(5));
    assert!(made.load(Ordering::SeqCst) <= 5 + 4);
}

#[test]
fn a_panic_of_make_ends_the_map() {
    let run = || in_order(10, 2, |index| assert_ne!(index, 3, "made to fail"), |_, ()| Ok::<(), ()>(()));
    assert!(catch_unwind(run).is_err());
}

#[test]
fn ends_on_every_thread_of_a_pool_at_once() {
    let sum_of_squares = |n: u32| (0..n).into_par_iter().map(u64::from).map(|i| i * i).sum::<u64>();
    let run = |_: usize| {
        let mut sums = Vec::new();
        let make = |index| sum_of_squares(index as u32);
        let ended = in_order(4, 2, make, |_, sum| {
            sums.push(sum);
            Ok::<(), ()>(())
        });
        ended.map(|()| sums)
    };
    let sums: Vec<_> = (0..200).into_par_iter().map(run).collect();
    assert_eq!(sums, vec![Ok(vec![0, 0, 1, 5]); 200]);
}
