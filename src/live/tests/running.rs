//! Peers that misbehave while rows come, and peers that come back.

use super::*;
use crate::rtde::Session;

/// A controller that agrees with its first client, and then does as `act` says.
fn agreed(act: impl FnOnce(TcpStream, Session) + Send + 'static) -> String {
    controller(move |mut socket| {
        let mut session = Session::new(Arc::new(Offer::new(500.0)));
        let mut buffer = [0; 4096];
        while session.heard().is_empty() {
            let count = socket.read(&mut buffer).unwrap();
            session.receive(&buffer[..count]).unwrap();
            socket.write_all(&session.outgoing()).unwrap();
        }
        act(socket, session);
    })
}

/// What a client makes of that, after the rows `sent` came to it.
fn told(sent: u64, act: impl FnOnce(TcpStream, Session) + Send + 'static) -> String {
    let address = agreed(move |mut socket, mut session| {
        let offer = Offer::new(500.0);
        (0..sent).for_each(|k| session.send(k, &row(&offer, k)));
        socket.write_all(&session.outgoing()).unwrap();
        act(socket, session);
    });
    let (rows, _, ended) = drain(&source(address).open().unwrap());
    assert_eq!(rows.len() as u64, sent, "what came before is kept");
    ended.unwrap_err().to_string()
}

#[test]
fn a_peer_that_goes_wrong_while_rows_come_is_told_of_and_rows_are_kept() {
    assert!(told(10, |_, _| {}).contains("closed by the other side"));
    let stalls = told(10, |_, _| std::thread::sleep(Duration::from_secs(6)));
    assert!(stalls.contains("nothing came for 3 s"), "{stalls}");
    let says = |bytes: &'static [u8]| {
        told(10, |mut socket, _| {
            socket.write_all(bytes).unwrap();
            // Until the client has gone.
            let _ = socket.read(&mut [0; 64]);
        })
    };
    let other = says(b"\x00\x04U\x09");
    assert!(other.contains("of 1 bytes, where 57 were expected"), "{other}");
    let short = says(b"\x00\x05U\x01\x00");
    assert!(short.contains("of 2 bytes, where 57 were expected"), "{short}");
    let garbage = says(b"\x7f\x45\x4c\x46");
    assert!(garbage.contains("no RTDE"), "{garbage}");
    let again = says(b"\x00\x04S\x01");
    assert!(again.contains("has no place"), "{again}");
}

/// A flood is taken up to what the queue holds; the rest is counted, and nothing grows.
#[test]
fn more_rows_than_there_is_room_for_are_counted() {
    let most = QUEUE as u64 + 5000;
    let address = agreed(move |mut socket, mut session| {
        let offer = Offer::new(500.0);
        for k in 0..most {
            session.send(k, &row(&offer, k));
            if k % 500 == 0 {
                socket.write_all(&session.outgoing()).unwrap();
            }
        }
        socket.write_all(&session.outgoing()).unwrap();
    });
    let feed = source(address).open().unwrap();
    let begun = Instant::now();
    while feed.lost() == 0 && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(feed.waiting(), QUEUE);
    let (rows, _, _) = drain(&feed);
    assert_eq!(rows.len() as u64 + feed.lost(), most);
    assert!(rows.windows(2).all(|pair| pair[1][0] > pair[0][0]));
}

/// The first rows of a server that `served` listens to, once its client has started.
fn served(server: &Server, rows: std::ops::Range<u64>) {
    let started = |e: Served| matches!(e, Served::Heard(_, crate::rtde::Heard::Started { .. }));
    let begun = Instant::now();
    while !server.events().into_iter().any(started) {
        assert!(begun.elapsed() < Duration::from_secs(20), "the client did not come");
        std::thread::sleep(Duration::from_millis(5));
    }
    rows.for_each(|k| server.send(k, &row(&Offer::new(500.0), k)));
}

#[test]
fn a_client_comes_back_when_its_controller_does() {
    let server = Server::start("127.0.0.1:0", Arc::new(Offer::new(500.0))).unwrap();
    let address = server.address.to_string();
    let feed = RtdeSource { reconnect: Reconnect::Always, ..source(address.clone()) };
    let feed = feed.open().unwrap();
    let (mut times, mut notes, mut begins) = (Vec::new(), Vec::new(), 0);
    let mut take = |most: usize, times: &mut Vec<f64>| {
        while times.len() < most {
            match feed.next(Duration::from_secs(20)) {
                Some(News::Row(row)) => times.push(row[0]),
                Some(News::Note(note)) => notes.push(note),
                Some(News::Columns(_)) => begins += 1,
                other => panic!("{other:?}"),
            }
        }
    };
    served(&server, 0..100);
    take(100, &mut times);
    drop(server);
    let server = Server::start(&address, Arc::new(Offer::new(500.0))).unwrap();
    served(&server, 400..500);
    take(200, &mut times);
    let expected: Vec<f64> = (0..100).chain(400..500).map(|k| k as f64 / 500.0).collect();
    assert_eq!((times, begins), (expected, 2), "{notes:?}");
    assert!(notes.iter().any(|note| note.ends_with("trying again")), "{notes:?}");
    feed.stop();
    assert!(drain(&feed).2.is_ok());
}
