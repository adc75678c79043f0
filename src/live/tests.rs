//! Client and server over loopback, and peers that misbehave. Nothing here waits for a clock to be exact.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::*;
use crate::rtde::{Offer, Wish};

fn source(address: String) -> RtdeSource {
    let wish = Wish {
        rate_hz: 500.0,
        needed: vec!["timestamp".into(), "actual_q".into()],
        welcome: vec![],
    };
    RtdeSource { address, wish, reconnect: Reconnect::Never }
}

/// All until the end, rows apart.
fn drain(feed: &Feed) -> (Vec<Vec<f64>>, Vec<String>, Result<(), LiveError>) {
    let (mut rows, mut notes) = (Vec::new(), Vec::new());
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(20) {
        match feed.next(Duration::from_millis(100)) {
            Some(News::Row(row)) => rows.push(row),
            Some(News::Note(note)) => notes.push(note),
            Some(News::End(ended)) => return (rows, notes, ended),
            _ => {}
        }
    }
    panic!("the source did not come to its end: {notes:?}");
}

fn row(offer: &Offer, k: u64) -> Vec<f64> {
    let mut row = offer.still.clone();
    row[offer.column("timestamp").unwrap()] = k as f64 / 500.0;
    row[offer.column("actual_q_2").unwrap()] = (k as f64).sin();
    row
}

#[test]
fn every_row_that_a_server_sends_arrives() {
    let offer = Arc::new(Offer::new(500.0));
    let server = Server::start("127.0.0.1:0", Arc::clone(&offer)).unwrap();
    let feed = source(server.address.to_string()).open().unwrap();
    while !server
        .events()
        .iter()
        .any(|e| matches!(e, Served::Heard(_, crate::rtde::Heard::Started { .. })))
    {
        std::thread::sleep(Duration::from_millis(5));
    }
    (0..2000).for_each(|k| {
        server.send(k, &row(&offer, k));
        // Slower than the reader: rows that find no room are another test.
        if k % 100 == 0 {
            std::thread::sleep(Duration::from_millis(5));
        }
    });
    // The program and its two notes are told of before the rows.
    let begun = Instant::now();
    while feed.waiting() < 2000 + 2 && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(5));
    }
    drop(server);
    let (rows, notes, ended) = drain(&feed);
    assert!(notes[0].contains("controller 5.11.6"), "{notes:?}");
    assert_eq!((rows.len(), feed.lost()), (2000, 0), "{ended:?}");
    assert!(matches!(ended, Err(LiveError::Closed { .. } | LiveError::Broken { .. })));
    for (k, got) in rows.iter().enumerate() {
        assert_eq!((got[0], got[3]), (k as f64 / 500.0, (k as f64).sin()));
    }
}

/// A controller that does as `act` says with its first client.
fn controller(act: impl FnOnce(TcpStream) + Send + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    std::thread::spawn(move || act(listener.accept().unwrap().0));
    address
}

#[test]
fn controllers_that_misbehave_are_told_of_in_one_sentence() {
    let told = |act: fn(TcpStream)| {
        let (rows, _, ended) = drain(&source(controller(act)).open().unwrap());
        assert!(rows.is_empty());
        ended.unwrap_err().to_string()
    };
    assert!(told(drop).contains("connection"));
    let flood = told(|mut socket| while socket.write_all(&[b'M'; 4096]).is_ok() {});
    assert!(flood.contains("no RTDE") || flood.contains("text"), "{flood}");
    let lie = told(|mut socket| {
        let _ = socket.write_all(b"\x00\x01V");
        let _ = socket.read(&mut [0; 64]);
    });
    assert!(lie.contains("a package of 1 bytes"), "{lie}");
    // Announces a long package and sends no more.
    let stalls = told(|mut socket| {
        let _ = socket.write_all(b"\xff\xffV\x01");
        std::thread::sleep(Duration::from_secs(6));
    });
    assert!(stalls.contains("nothing came for 3 s"), "{stalls}");
    let nobody = source("127.0.0.1:1".into()).open().unwrap();
    let nobody = drain(&nobody).2.unwrap_err().to_string();
    assert!(nobody.contains("no controller answers"), "{nobody}");
}

#[test]
fn a_flood_of_text_is_told_of_once() {
    let (_, notes, _) = drain(
        &source(controller(|mut socket| {
            let text = b"\x00\x0eM\x05hello\x03you\x02";
            for _ in 0..20_000 {
                if socket.write_all(text).is_err() {
                    break;
                }
            }
        }))
        .open()
        .unwrap(),
    );
    assert_eq!(notes.len(), 20, "{notes:?}");
    assert!(notes[19].contains("further messages are not shown"));
}

#[test]
fn clients_that_send_what_they_should_not_are_dropped() {
    let offer = Arc::new(Offer::new(125.0));
    let server = Server::start("127.0.0.1:0", Arc::clone(&offer)).unwrap();
    for bad in [&b"GET / HTTP/1.1\r\n\r\n"[..], b"\x00\x00V", b"\x00\x04U\x01"] {
        let mut client = TcpStream::connect(server.address).unwrap();
        client.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        client.write_all(bad).unwrap();
        assert!(matches!(client.read(&mut [0; 8]), Ok(0) | Err(_)), "it is closed");
    }
    let begun = Instant::now();
    let mut went = Vec::new();
    while went.len() < 3 && begun.elapsed() < Duration::from_secs(10) {
        let why = server.events().into_iter().filter_map(|e| match e {
            Served::Went(_, why) => why,
            _ => None,
        });
        went.extend(why);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(went[0].contains("unknown kind") && went[1].contains("0 bytes"), "{went:?}");
    assert_eq!(server.clients(), 0);
}

/// Who asks for everything and reads nothing costs a bounded number of bytes, and is dropped.
#[test]
fn a_client_that_does_not_read_is_dropped() {
    let offer = Arc::new(Offer::new(500.0));
    let server = Server::start("127.0.0.1:0", Arc::clone(&offer)).unwrap();
    let mut client = TcpStream::connect(server.address).unwrap();
    let names = ["actual_q"; 400].join(",");
    client.write_all(&((3 + names.len()) as u16).to_be_bytes()).unwrap();
    client.write_all(&[b"O", names.as_bytes(), b"\x00\x03S"].concat()).unwrap();
    let begun = Instant::now();
    let mut why = None;
    for k in 0.. {
        server.send(k, &offer.still);
        for event in server.events() {
            if let Served::Went(_, said) = event {
                why = said;
            }
        }
        if why.is_some() || begun.elapsed() > Duration::from_secs(20) {
            break;
        }
        if k % 50 == 0 {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    assert!(why.unwrap().contains("bytes that a client has not read"));
    assert_eq!(server.clients(), 0);
}

#[test]
fn a_source_that_cannot_wait_counts_what_found_no_room() {
    let feed = Feed::start(false, |out| {
        (0..QUEUE as u64 + 100).for_each(|k| out.row(vec![k as f64]));
        while !out.stopped() {
            std::thread::yield_now();
        }
        Ok(())
    })
    .unwrap();
    while feed.lost() < 100 {
        std::thread::yield_now();
    }
    assert_eq!(feed.waiting(), QUEUE);
    feed.stop();
    assert_eq!(drain(&feed).0.len(), QUEUE);
}

#[test]
fn a_file_is_followed_while_it_grows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    std::fs::write(&path, "timestamp actual_q_0\n0.0 1.5\n0.008 1.6\n0.0").unwrap();
    let feed = follow(&path, None).unwrap();
    let mut rows = Vec::new();
    while rows.len() < 4 {
        match feed.next(Duration::from_secs(10)) {
            Some(News::Row(row)) => rows.push(row),
            Some(News::Columns(names)) => {
                assert_eq!(names, ["timestamp", "actual_q_0"]);
                let mut file = std::fs::OpenOptions::new().append(true).open(&path).unwrap();
                file.write_all(b"16 1.7\nbroken\n0.024 1.8\n").unwrap();
            }
            Some(News::Note(note)) => assert!(note.contains("row 5"), "{note}"),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(rows[2..], [[0.016, 1.7], [0.024, 1.8]]);
    feed.stop();
    assert!(drain(&feed).2.is_ok());
}
