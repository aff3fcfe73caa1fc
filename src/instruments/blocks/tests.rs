use super::*;

/// The total and the rows in it, over all blocks.
fn total(blocks: &Blocks<1, 1>) -> (f32, f32) {
    let (mut sum, mut rows) = (blocks.fresh.psi[0], blocks.fresh_rows as f32);
    for block in &blocks.blocks {
        sum += block.weight * block.sums.psi[0];
        rows += block.weight * block.rows;
    }
    (sum, rows)
}

#[test]
fn nothing_is_lost_and_blocks_stay_of_one_length() {
    let mut blocks = Blocks::<1, 1>::new(1.0);
    for k in 1..20_000_u32 {
        blocks.update(&[1.0], &[2.0], 3.0, 1);
        let (sum, rows) = total(&blocks);
        assert_eq!((sum, rows), (3.0 * k as f32, k as f32));
        let effective = blocks.effective();
        assert!(
            k < 128 || (7.9..=16.0).contains(&effective),
            "{k}: {effective}"
        );
    }
    // 20 000 rows in 8 to 16 blocks of 8 times a power of two.
    assert_eq!(blocks.length, 2048);
    let whole = blocks.blocks.iter().filter(|block| block.rows == 2048.0);
    assert_eq!(whole.count(), 9);
}

#[test]
fn with_a_memory_blocks_fade() {
    // A memory of 1000 rows: blocks of 15, 30, .. 120 rows.
    let mut blocks = Blocks::<1, 1>::new(0.999);
    for _ in 0..50_000 {
        blocks.update(&[1.0], &[1.0], 1.0, 1);
    }
    assert_eq!(blocks.length, 120);
    let (_, rows) = total(&blocks);
    // 1000, up to half a block.
    assert!((rows - 1000.0).abs() < 70.0, "{rows}");
    assert!(
        (10.0..14.0).contains(&blocks.effective()),
        "{}",
        blocks.effective()
    );
}

#[test]
fn held_blocks_stay() {
    let mut blocks = Blocks::<1, 1>::new(1.0);
    for _ in 0..200 {
        blocks.update(&[1.0], &[1.0], 1.0, 1);
    }
    let before = blocks.blocks.clone();
    for _ in 0..300 {
        blocks.hold(8);
        blocks.update(&[1.0], &[1.0], 1.0, 1);
    }
    assert_eq!(blocks.blocks, before);
    for _ in 0..20 {
        blocks.update(&[1.0], &[1.0], 1.0, 1);
    }
    assert!(blocks.blocks != before);
    assert_eq!(total(&blocks), (520.0, 520.0));
}

#[test]
fn another_last_parameter_leaves_the_sums_of_the_others() {
    // psi = 3 phi_0 + 5 phi_1, and from then on another second parameter.
    let row = |k: u32| {
        [
            f32::from(k.is_multiple_of(3)),
            f32::from(k.is_multiple_of(2)),
        ]
    };
    let (mut blocks, mut alone) = (Blocks::<2, 2>::new(1.0), Blocks::<2, 2>::new(1.0));
    for k in 0..1000 {
        let [first, last] = row(k);
        blocks.update(&[first, last], &[first, last], 3.0 * first + 5.0 * last, 1);
        alone.update(&[first, 0.0], &[first, 0.0], 3.0 * first, 1);
    }
    let before = blocks.changes;
    blocks.settle_last(5.0);
    assert_ne!(blocks.changes, before);
    assert_eq!(blocks.fresh, alone.fresh);
    for (found, exact) in blocks.blocks.iter().zip(&alone.blocks) {
        assert_eq!(found, exact);
    }
}
