//! Standard input, read ahead. In: bytes, as they come. Out: the same bytes for the reader of rows, and before it has to wait for more of
//! them every row that was read is answered and shown: a program at the other end of the pipes gets every answer before it asks the next
//! question.

use std::cell::RefCell;
use std::io::{self, ErrorKind, Read};
use std::rc::Rc;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread;

use csv::ByteRecord;
use workshop::failure::Failure;

use super::CAPACITY;
use super::answering::Answering;

/// The longest row, in bytes; what is longer is no table, and would have to be kept as a whole.
const LONGEST_ROW: u64 = 1 << 20;

/// The number of chunks that are read ahead. One is ready while the current one is processed, and one is being read.
const AHEAD: usize = 2;

/// What was read of standard input, by a thread of its own.
pub(super) struct Chunks {
    ahead: Receiver<io::Result<Vec<u8>>>,
    chunk: Vec<u8>,
    /// How much of it was taken.
    taken: usize,
    /// Whether nothing comes any more.
    ended: bool,
}

impl Chunks {
    /// Begins to read, and waits for the first bytes.
    pub(super) fn begin() -> io::Result<Self> {
        let (sender, ahead) = sync_channel(AHEAD);
        thread::spawn(move || read_ahead(&sender));
        let mut chunks = Self { ahead, chunk: Vec::new(), taken: 0, ended: false };
        chunks.wait()?;
        Ok(chunks)
    }

    /// What is there and was not taken.
    pub(super) fn rest(&self) -> &[u8] {
        self.chunk.get(self.taken..).unwrap_or_default()
    }

    /// Takes the next chunk where there is one; `false` where one would have to wait.
    fn is_ready(&mut self) -> io::Result<bool> {
        match self.ahead.try_recv() {
            Ok(chunk) => self.take(chunk).map(|()| true),
            Err(TryRecvError::Empty) => Ok(false),
            Err(TryRecvError::Disconnected) => {
                self.ended = true;
                Ok(true)
            }
        }
    }

    /// Waits for the next chunk.
    fn wait(&mut self) -> io::Result<()> {
        match self.ahead.recv() {
            Ok(chunk) => self.take(chunk),
            Err(_) => {
                self.ended = true;
                Ok(())
            }
        }
    }

    fn take(&mut self, chunk: io::Result<Vec<u8>>) -> io::Result<()> {
        (self.chunk, self.taken) = (chunk?, 0);
        Ok(())
    }
}

/// Reads standard input to its end, or until nobody wants more of it.
fn read_ahead(sender: &SyncSender<io::Result<Vec<u8>>>) {
    let mut stdin = io::stdin().lock();
    loop {
        let mut chunk = vec![0; CAPACITY];
        let read = match stdin.read(&mut chunk) {
            Ok(0) => return,
            Ok(count) => {
                chunk.truncate(count);
                Ok(chunk)
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) => Err(error),
        };
        let last = read.is_err();
        if sender.send(read).is_err() || last {
            return;
        }
    }
}

/// Standard input for the reader of rows.
pub(super) struct Input<'s, 'c> {
    chunks: Chunks,
    answering: Rc<RefCell<Answering<'s, 'c>>>,
    /// How many bytes were given away.
    given: u64,
    /// The last of them.
    last: u8,
}

impl<'s, 'c> Input<'s, 'c> {
    /// Standard input, with those who answer what it brings.
    pub(super) fn new(chunks: Chunks, answering: Rc<RefCell<Answering<'s, 'c>>>) -> Self {
        Self { chunks, answering, given: 0, last: 0 }
    }

    /// Whether the input breaks off in a row that ends after this number of bytes: it is the last one, and either its line has no end or a
    /// quote in its last cell is still open.
    pub(super) fn broke_off(&self, row: &ByteRecord, bytes: u64) -> bool {
        bytes == self.given && (self.last != b'\n' || row.as_slice().ends_with(b"\n"))
    }

    /// Has the next bytes at hand, but at the end; all that was read is answered where one has to wait for them.
    fn provide(&mut self) -> io::Result<()> {
        if !self.chunks.rest().is_empty() || self.chunks.ended || self.chunks.is_ready()? {
            return Ok(());
        }
        let mut answering = self.answering.borrow_mut();
        if let Err(failure) = answering.answer().and_then(|()| answering.flush()) {
            answering.failure = Some(failure);
            return Err(io::Error::other("the rows before could not be answered"));
        }
        self.chunks.wait()
    }
}

impl Read for Input<'_, '_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut answering = self.answering.borrow_mut();
        if self.given.saturating_sub(answering.begun) > LONGEST_ROW {
            let mistake = "error: standard input: a row is longer than 1 MiB";
            answering.failure = Some(Failure::no(mistake.to_owned()));
            return Err(io::Error::other("the row is too long"));
        }
        drop(answering);
        self.provide()?;
        let read = self.chunks.rest().read(buffer)?;
        self.chunks.taken = self.chunks.taken.saturating_add(read);
        self.last = buffer.get(..read).and_then(<[u8]>::last).copied().unwrap_or(self.last);
        self.given = self.given.saturating_add(u64::try_from(read).unwrap_or_default());
        Ok(read)
    }
}
