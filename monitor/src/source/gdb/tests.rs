//! A stub as that of QEMU, over memory of the test.

use std::net::TcpListener;
use std::sync::Mutex;

use super::*;
use crate::source::rtt::tests::{RAM, Ram};

/// A stub over `ram`, for one caller, as QEMU's: it stops the target when somebody calls and says
/// so, a byte while the target runs stops it and is heard as that only, and an answer that nobody
/// has acknowledged is said by a question only. Gives how often it was stopped.
pub(in crate::source) fn serve(listener: &TcpListener, ram: &Mutex<Ram>) -> usize {
    let (mut stream, _) = listener.accept().unwrap();
    let (mut runs, mut stops, mut unheard) = (false, 1, true);
    let mut text = Vec::new();
    stream.write_all(&packet("T02thread:01;")).unwrap();
    loop {
        let mut byte = [0];
        if stream.read_exact(&mut byte).is_err() {
            return stops;
        }
        if unheard && byte[0] != b'$' {
            unheard = byte[0] != b'+';
            continue;
        }
        if runs {
            (runs, unheard, stops) = (false, true, stops + 1);
            stream.write_all(&packet("T02thread:01;")).unwrap();
            continue;
        }
        unheard = false;
        match byte[0] {
            b'$' => text.clear(),
            b'+' | 0x03 if text.is_empty() => continue,
            _ => {}
        }
        text.push(byte[0]);
        let [b'$', body @ .., b'#', _, _] = &text[..] else {
            continue;
        };
        assert_eq!(
            &text[text.len() - 2..],
            format!("{:02x}", check(body)).as_bytes()
        );
        let body = String::from_utf8(body.to_vec()).unwrap();
        text.clear();
        stream.write_all(b"+").unwrap();
        if body == "c" {
            runs = true;
            continue;
        }
        let said = answer(&body, &mut ram.lock().unwrap());
        stream.write_all(&packet(&said)).unwrap();
        unheard = true;
    }
}

fn answer(body: &str, ram: &mut Ram) -> String {
    let number = |text: &str| u32::from_str_radix(text, 16).unwrap();
    if body == "?" {
        return "T05thread:01;".into();
    }
    let Some((at, rest)) = body.get(1..).and_then(|rest| rest.split_once(',')) else {
        return String::new();
    };
    let done = match &body[..1] {
        "m" => {
            let mut bytes = vec![0; number(rest) as usize];
            let read = ram.read(number(at), &mut bytes);
            read.map(|()| bytes.iter().map(|byte| format!("{byte:02x}")).collect())
        }
        "M" => {
            let (count, data) = rest.split_once(':').unwrap();
            let bytes = bytes_of(data.as_bytes()).unwrap();
            assert_eq!(bytes.len(), number(count) as usize);
            ram.write(number(at), &bytes).map(|()| "OK".into())
        }
        _ => Ok(String::new()),
    };
    done.unwrap_or_else(|_| "E14".into())
}

#[test]
fn memory_is_read_and_written_while_the_target_stands_still() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let ram = Mutex::new(Ram::new());
    let stops = thread::scope(|scope| {
        let served = scope.spawn(|| serve(&listener, &ram));
        let mut gdb = Gdb::new(TcpStream::connect(address).unwrap()).unwrap();
        for k in 0..20_u8 {
            gdb.stop().unwrap();
            // More than a packet has.
            let bytes: Vec<u8> = (0..1200_u32).map(|i| i as u8 ^ k).collect();
            gdb.write(RAM + 0x800, &bytes).unwrap();
            let mut back = vec![0; bytes.len()];
            gdb.read(RAM + 0x800, &mut back).unwrap();
            assert_eq!(back, bytes);
            gdb.go_on().unwrap();
        }
        gdb.stop().unwrap();
        let why = gdb.read(0, &mut [0; 4]).unwrap_err();
        assert!(why.contains("does not read 0x0: `E14`"), "{why}");
        assert!(gdb.write(RAM - 1, &[0]).is_err());
        drop(gdb);
        served.join().unwrap()
    });
    assert_eq!(stops, 22);
}

#[test]
fn what_is_no_answer_ends_the_line_with_a_reason() {
    for (said, why) in [
        (&b"$T05#00"[..], "wrong check sum"),
        (b"$T05#zz", "wrong check sum"),
        (b"hello", "closed the line"),
    ] {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let error = thread::scope(|scope| {
            scope.spawn(|| {
                let (mut stream, _) = listener.accept().unwrap();
                stream.write_all(said).unwrap();
                stream.shutdown(std::net::Shutdown::Write).unwrap();
                // What the other end still says.
                let _ = stream.read_to_end(&mut Vec::new());
            });
            Gdb::new(TcpStream::connect(address).unwrap())
                .err()
                .unwrap()
        });
        assert!(error.contains(why), "{error}");
    }
}
