//! Work on all processors.

use std::sync::Mutex;

use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// What `one` makes of each of `items`, in their order.
///
/// The processors are shared by one piece of code, whatever the items and results: a compiler that
/// made it anew for each kind of work would spend seconds on it.
pub fn side_by_side<I: Sync, T: Send>(items: &[I], one: impl Fn(&I) -> T + Sync) -> Vec<T> {
    let results: Vec<Mutex<Option<T>>> = items.iter().map(|_| Mutex::new(None)).collect();
    on_all_processors(items.len(), &|k| {
        if let (Some(item), Some(result)) = (items.get(k), results.get(k)) {
            let made = one(item);
            // Only this piece of work has the lock: it cannot be poisoned.
            if let Ok(mut result) = result.lock() {
                *result = Some(made);
            }
        }
    });
    let results = results.into_iter();
    results
        .filter_map(|result| result.into_inner().ok().flatten())
        .collect()
}

fn on_all_processors(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(work);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_result_stands_where_its_item_stood() {
        let items: Vec<u64> = (0..1000).collect();
        let squares = side_by_side(&items, |k| (*k, k * k));
        assert_eq!(squares.len(), items.len());
        for (k, (item, square)) in squares.iter().enumerate() {
            assert_eq!((*item, *square), (k as u64, (k * k) as u64));
        }
        assert!(side_by_side(&[] as &[u8], |_| ()).is_empty());
    }

    #[test]
    #[should_panic(expected = "the seventh")]
    fn a_panic_reaches_the_caller() {
        let _ = side_by_side(&[6, 7, 8], |k| assert!(*k != 7, "the seventh"));
    }
}
