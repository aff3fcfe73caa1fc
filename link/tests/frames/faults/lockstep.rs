//! Every sample is processed once, whatever the line does.

use trendid_link::*;

use super::ends::{Line, Target, mix, plain, reply, reset};

#[test]
fn every_sample_is_processed_once_on_a_bad_line() {
    for seed in 1..=20 {
        let mut line = Line::new(seed, 5);
        // Starts just before the wrap of the sequence number.
        let mut exchange = Exchange::new(u32::MAX - 500, 50);
        let mut expected = 0;
        let mut last = None;
        for k in 0..2000u32 {
            let mut sample = plain(0, k.wrapping_mul(0x9E37_79B9).cast_signed());
            if k % 11 == 0 {
                sample.code = None;
            }
            expected = mix(expected, &sample);
            let got = exchange.exchange(&mut line, sample).expect("a reply");
            assert_eq!(
                got.fields(),
                reply(expected).fields(),
                "seed {seed}, sample {k}"
            );
            last = Some(got);
        }
        let target = line.target.responder.counters();
        let host = exchange.counters();
        assert_eq!(line.target.processed, 2000, "seed {seed}");
        assert!(
            line.injected.iter().all(|&count| count > 50),
            "seed {seed}: {:?}",
            line.injected
        );
        // Every kind of fault is seen by somebody: damage by a check sum, loss by a timeout,
        // doubles by the number.
        assert!(
            target.corrupt > 20 && host.corrupt > 20,
            "seed {seed}: {target:?} {host:?}"
        );
        assert!(host.lost > 100, "seed {seed}: {host:?}");
        assert!(target.repeated > 100, "seed {seed}: {target:?}");
        assert_eq!(target.lost, 0, "seed {seed}: the lockstep leaves no gap");
        assert!(last.expect("a reply").counters.repeated > 100);
    }
}

#[test]
fn a_clean_line_counts_nothing() {
    let mut line = Line::new(1, u32::MAX);
    let mut exchange = Exchange::new(0, 1);
    for k in 0..1000u32 {
        exchange
            .exchange(&mut line, plain(0, k.cast_signed()))
            .expect("a reply");
    }
    assert_eq!(exchange.counters(), Counters::default());
    assert_eq!(line.target.responder.counters(), Counters::default());
}

#[test]
fn a_dead_line_is_an_error() {
    struct Dead(u32);
    impl Bytes for Dead {
        type Error = ();
        fn send(&mut self, _: &[u8]) -> Result<(), ()> {
            self.0 += 1;
            Ok(())
        }
        fn receive(&mut self, _: &mut [u8]) -> Result<usize, ()> {
            Ok(0)
        }
    }
    let mut line = Dead(0);
    let mut exchange = Exchange::new(9, 3);
    assert_eq!(
        exchange.exchange(&mut line, plain(0, 0)),
        Err(ExchangeError::NoReply(9))
    );
    assert_eq!(line.0, 3);
    assert_eq!(exchange.counters().lost, 3);
}

#[test]
fn a_gap_and_an_old_frame_are_counted() {
    let mut target = Target::default();
    let mut out = Vec::new();
    for seq in [10, 13, 12] {
        for &byte in Frame::encode(&plain(seq, 1)).bytes() {
            target.push(byte, &mut out);
        }
    }
    assert_eq!(target.processed, 2);
    assert_eq!(
        target.responder.counters(),
        Counters {
            corrupt: 0,
            lost: 2,
            repeated: 1
        }
    );
}

/// What was answered before is no answer to a sample that has none yet.
#[test]
fn a_sample_that_comes_again_before_its_answer_gets_none_of_another() {
    let mut responder = Responder::new();
    let take = |responder: &mut Responder, seq| {
        let frame = Frame::encode(&plain(seq, 1));
        frame.bytes().iter().find_map(|&byte| responder.push(byte))
    };
    assert_eq!(take(&mut responder, 1), Some(Incoming::New(plain(1, 1))));
    assert!(!responder.answer(reply(0)).is_empty());
    assert_eq!(take(&mut responder, 1), Some(Incoming::Repeated));
    assert_eq!(take(&mut responder, 2), Some(Incoming::New(plain(2, 1))));
    assert_eq!(responder.cached(), []);
    assert_eq!(take(&mut responder, 2), Some(Incoming::Stale));
}

#[test]
fn a_reset_clears_the_counters_and_takes_any_number() {
    let mut target = Target::default();
    let mut out = Vec::new();
    for byte in [0, 1, 2, 3, 0] {
        target.push(byte, &mut out);
    }
    assert_eq!(target.responder.counters().corrupt, 1);
    for sample in [plain(10, 1), plain(13, 1), reset(5), reset(5)] {
        for &byte in Frame::encode(&sample).bytes() {
            target.push(byte, &mut out);
        }
    }
    assert_eq!(
        target.processed, 3,
        "the repeated reset is answered from the cache"
    );
    assert_eq!(
        target.responder.counters(),
        Counters {
            corrupt: 0,
            lost: 0,
            repeated: 1
        }
    );
}
