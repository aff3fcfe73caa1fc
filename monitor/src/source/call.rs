//! Where the emulator calls: a socket of the file system, where a byte costs it much less than over
//! TCP, which its end that is a debugger's stub needs, and so does a system without such sockets.

use std::io;
use std::net::{TcpListener, TcpStream};

use crate::source::line::prompt;

/// A place that one call comes to.
pub(super) trait Place {
    /// A line that was called.
    type Stream;

    /// What follows `socket,` in an option of QEMU.
    fn option(&self) -> io::Result<String>;

    /// The call, or `WouldBlock` while there is none.
    fn answer(&self) -> io::Result<Self::Stream>;
}

/// A port of this computer.
pub(super) struct Port(TcpListener);

impl Port {
    pub(super) fn new() -> io::Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0")?;
        listener.set_nonblocking(true)?;
        Ok(Self(listener))
    }
}

impl Place for Port {
    type Stream = TcpStream;

    fn option(&self) -> io::Result<String> {
        let port = self.0.local_addr()?.port();
        Ok(format!("host=127.0.0.1,port={port},nodelay=on"))
    }

    fn answer(&self) -> io::Result<TcpStream> {
        let (stream, _) = self.0.accept()?;
        stream.set_nonblocking(false)?;
        prompt(&stream)?;
        Ok(stream)
    }
}

#[cfg(not(unix))]
pub(super) use Port as File;
#[cfg(unix)]
pub(super) use file::File;

#[cfg(unix)]
mod file {
    use std::os::unix::net::{UnixListener, UnixStream};
    use std::path::PathBuf;
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::{env, fs, io, process};

    use crate::source::call::Place;
    use crate::source::line::WAIT;

    /// Calls so far: each has a file of its own.
    static NEXT: AtomicU32 = AtomicU32::new(0);

    /// A socket in the directory for what is temporary; it goes with this.
    pub(in crate::source) struct File(UnixListener, PathBuf);

    impl File {
        pub(in crate::source) fn new() -> io::Result<Self> {
            let number = NEXT.fetch_add(1, Ordering::Relaxed);
            let name = format!("trendid-{}-{number}.socket", process::id());
            let path = env::temp_dir().join(name);
            // Left by a program that was killed and had the same number.
            let _ = fs::remove_file(&path);
            let listener = UnixListener::bind(&path)?;
            listener.set_nonblocking(true)?;
            Ok(Self(listener, path))
        }
    }

    impl Place for File {
        type Stream = UnixStream;

        fn option(&self) -> io::Result<String> {
            let path = self.1.to_str().ok_or(io::ErrorKind::InvalidInput)?;
            // A comma stands between options.
            Ok(format!("path={}", path.replace(',', ",,")))
        }

        fn answer(&self) -> io::Result<UnixStream> {
            let (stream, _) = self.0.accept()?;
            stream.set_nonblocking(false)?;
            stream.set_read_timeout(Some(WAIT))?;
            Ok(stream)
        }
    }

    impl Drop for File {
        fn drop(&mut self) {
            // What is left is an empty name.
            let _ = fs::remove_file(&self.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};

    use super::*;

    #[test]
    fn a_port_waits_until_it_is_called() {
        let port = Port::new().unwrap();
        assert_eq!(port.answer().unwrap_err().kind(), io::ErrorKind::WouldBlock);
        let mut caller = TcpStream::connect(port.0.local_addr().unwrap()).unwrap();
        caller.write_all(b"here").unwrap();
        let mut stream = loop {
            match port.answer() {
                Ok(stream) => break stream,
                Err(error) => assert_eq!(error.kind(), io::ErrorKind::WouldBlock),
            }
        };
        let mut heard = [0; 4];
        stream.read_exact(&mut heard).unwrap();
        assert_eq!(&heard, b"here");
    }

    #[cfg(unix)]
    #[test]
    fn a_file_waits_until_it_is_called_and_is_gone_with_its_place() {
        let file = File::new().unwrap();
        assert_eq!(file.answer().unwrap_err().kind(), io::ErrorKind::WouldBlock);
        let option = file.option().unwrap();
        let path = option.strip_prefix("path=").unwrap().replace(",,", ",");
        let mut caller = std::os::unix::net::UnixStream::connect(&path).unwrap();
        caller.write_all(b"here").unwrap();
        let mut stream = file.answer().unwrap();
        let mut heard = [0; 4];
        stream.read_exact(&mut heard).unwrap();
        assert_eq!(&heard, b"here");
        // Another has another file, and nothing is left of either.
        let other = File::new().unwrap();
        assert_ne!(other.option().unwrap(), option);
        drop(file);
        assert!(!std::path::Path::new(&path).exists());
    }
}
