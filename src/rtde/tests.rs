//! Both ends against each other in memory, and against bytes that nobody should send.

use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::frame::put;
use super::*;

const FIELDS: [&str; 4] = ["timestamp", "actual_q", "joint_mode", "actual_digital_input_bits"];

fn wish(needed: &[&str], welcome: &[&str]) -> Wish {
    let own = |names: &[&str]| names.iter().map(ToString::to_string).collect();
    Wish { rate_hz: 125.0, needed: own(needed), welcome: own(welcome) }
}

fn offer() -> Arc<Offer> {
    Arc::new(Offer::new(500.0))
}

/// Lets both talk until neither has anything to say, in pieces of `piece` bytes.
fn talk(client: &mut Client, session: &mut Session, piece: usize) -> Result<(), RtdeError> {
    loop {
        let (asked, answered) = (client.outgoing(), session.outgoing());
        if asked.is_empty() && answered.is_empty() {
            return Ok(());
        }
        asked.chunks(piece).try_for_each(|bytes| session.receive(bytes))?;
        answered.chunks(piece).try_for_each(|bytes| client.receive(bytes))?;
    }
}

fn events(client: &mut Client) -> Vec<Event> {
    std::iter::from_fn(|| client.next_event()).collect()
}

/// A row with a number of its own in every column, awkward ones among them.
fn odd_row(offer: &Offer) -> Vec<f64> {
    let mut row = offer.still.clone();
    let (_, q) = offer.find("actual_q").unwrap();
    let awkward = [0.1 + 0.2, -0.0, f64::MIN_POSITIVE, 1e300, -std::f64::consts::PI, 5e-324];
    row[q..q + 6].copy_from_slice(&awkward);
    row[offer.find("actual_digital_input_bits").unwrap().1] = 9007199254740991.0;
    row[offer.find("timestamp").unwrap().1] = 1234.568;
    row
}

#[test]
fn rows_arrive_to_the_last_bit_however_the_stream_is_cut() {
    for piece in [1, 2, 3, 7, 64, 65536] {
        let offer = offer();
        let (mut client, mut session) =
            (Client::new(wish(&FIELDS, &[])), Session::new(offer.clone()));
        talk(&mut client, &mut session, piece).unwrap();
        let row = odd_row(&offer);
        (0..40).for_each(|k| session.send(k, &row));
        talk(&mut client, &mut session, piece).unwrap();
        let events = events(&mut client);
        let [Event::Controller(version), Event::Started(recipe), rows @ ..] = &events[..] else {
            panic!("{events:?}")
        };
        assert_eq!((version.to_string().as_str(), recipe.width()), ("5.11.6.1010327", 14));
        assert_eq!(recipe.columns()[..3], ["timestamp", "actual_q_0", "actual_q_1"]);
        // 125 of the 500 rows per second.
        assert_eq!(rows.len(), 10);
        let (_, q) = offer.find("actual_q").unwrap();
        let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        for event in rows {
            let Event::Row(got) = event else { panic!("{event:?}") };
            assert_eq!(bits(&got[..7]), bits(&[&[1234.568], &row[q..q + 6]].concat()));
            assert_eq!(got[7..], [253.0, 253.0, 253.0, 253.0, 253.0, 253.0, 9007199254740991.0]);
        }
    }
}

#[test]
fn what_a_controller_does_not_know_is_left_out_or_refused() {
    let mut session = Session::new(offer());
    let mut client = Client::new(wish(&["timestamp"], &["actual_q", "no_such_thing"]));
    talk(&mut client, &mut session, 999).unwrap();
    let events = events(&mut client);
    assert_eq!(events[1], Event::Missing(vec!["no_such_thing".into()]));
    assert!(matches!(&events[2], Event::Started(r) if r.columns().len() == 7), "{events:?}");

    let mut session = Session::new(offer());
    let mut client = Client::new(wish(&["timestamp", "no_such_thing"], &[]));
    let refused = talk(&mut client, &mut session, 999).unwrap_err();
    assert_eq!(refused, RtdeError::NotFound("no_such_thing".into()));
}

#[test]
fn a_pause_lasts_until_the_client_resumes() {
    let offer = offer();
    let (mut client, mut session) = (Client::new(wish(&FIELDS, &[])), Session::new(offer.clone()));
    talk(&mut client, &mut session, 999).unwrap();
    events(&mut client);
    client.pause();
    assert!(client.is_paused() && !client.runs());
    // On its way when the pause is asked for.
    session.send(0, &offer.still);
    talk(&mut client, &mut session, 999).unwrap();
    session.send(4, &offer.still);
    talk(&mut client, &mut session, 999).unwrap();
    let seen = events(&mut client);
    assert!(matches!(&seen[..], [Event::Row(_), Event::Paused]), "{seen:?}");
    client.resume();
    talk(&mut client, &mut session, 999).unwrap();
    session.send(8, &offer.still);
    talk(&mut client, &mut session, 999).unwrap();
    let seen = events(&mut client);
    assert!(matches!(&seen[..], [Event::Resumed, Event::Row(_)]), "{seen:?}");
}

#[test]
fn text_goes_both_ways_in_both_protocols() {
    let mut session = Session::new(offer());
    session.say(Level::Warning, "old");
    assert_eq!(session.outgoing(), b"\x00\x07M\x02old");
    let mut client = Client::new(wish(&FIELDS, &[]));
    talk(&mut client, &mut session, 999).unwrap();
    session.say(Level::Error, "protective\u{1b}[31m stop");
    talk(&mut client, &mut session, 999).unwrap();
    let Some(Event::Text(text)) = events(&mut client).pop() else { panic!() };
    assert_eq!((text.level, text.source.as_str()), (Level::Error, "armtwin"));
    assert_eq!(text.message, "protective [31m stop", "nothing steers the terminal");
    let mut bytes = Vec::new();
    put(Kind::Text, &text.body(2), &mut bytes);
    session.receive(&bytes).unwrap();
    assert!(matches!(&session.heard()[..], [Heard::Started { .. }, Heard::Text(t)] if *t == text));
}

#[test]
fn protocol_1_has_neither_rate_nor_recipe_numbers() {
    let offer = offer();
    let mut session = Session::new(offer.clone());
    let mut bytes = Vec::new();
    put(Kind::SetupOutputs, b"timestamp,nothing", &mut bytes);
    session.receive(&bytes).unwrap();
    assert_eq!(session.outgoing(), b"\x00\x13ODOUBLE,NOT_FOUND"[..].to_vec().as_slice());
    bytes.clear();
    put(Kind::SetupOutputs, b"timestamp", &mut bytes);
    put(Kind::Start, b"", &mut bytes);
    session.receive(&bytes).unwrap();
    session.send(0, &odd_row(&offer));
    let expected =
        [&b"\x00\x09ODOUBLE\x00\x04S\x01\x00\x0bU"[..], &1234.568f64.to_be_bytes()].concat();
    assert_eq!(session.outgoing(), expected);
}

#[test]
fn registers_read_back_as_they_were_written() {
    let offer = offer();
    let mut session = Session::new(offer.clone());
    let mut client = Client::new(wish(&["input_double_register_3", "input_int_register_47"], &[]));
    talk(&mut client, &mut session, 999).unwrap();
    let mut bytes = Vec::new();
    put(Kind::SetupInputs, b"input_int_register_47,input_double_register_3", &mut bytes);
    let data = [&[1u8], &(-7i32).to_be_bytes()[..], &0.1f64.to_be_bytes()].concat();
    put(Kind::Data, &data, &mut bytes);
    session.receive(&bytes).unwrap();
    assert_eq!(session.outgoing(), b"\x00\x10I\x01INT32,DOUBLE");
    session.send(0, &offer.still);
    talk(&mut client, &mut session, 999).unwrap();
    assert_eq!(events(&mut client).pop(), Some(Event::Row(vec![0.1, -7.0])));
}

#[test]
fn lies_are_told_in_words() {
    let lie = |bytes: &[u8]| Session::new(offer()).receive(bytes).unwrap_err().to_string();
    assert!(lie(b"\x00\x02V").contains("package of 2 bytes"));
    assert!(lie(b"GET / HTTP/1.1\r\n").contains("unknown kind 84"));
    assert!(lie(b"\x00\x04V\x00").contains("has 1 bytes, 2 were expected"));
    assert!(lie(b"\x00\x04U\x09").contains("a data package where that has no place"));
    let many = "a,".repeat(600);
    let mut bytes = Vec::new();
    put(Kind::SetupInputs, many.as_bytes(), &mut bytes);
    assert!(lie(&bytes).contains("more than 512 quantities in a recipe"));
    bytes.clear();
    put(Kind::ProtocolVersion, &2u16.to_be_bytes(), &mut bytes);
    put(Kind::SetupOutputs, &[&f64::NAN.to_be_bytes()[..], b"timestamp"].concat(), &mut bytes);
    assert!(lie(&bytes).contains("asked for NaN Hz"));

    let told = |answers: &[(Kind, &[u8])]| {
        let mut client = Client::new(wish(&["timestamp"], &[]));
        let mut bytes = Vec::new();
        answers.iter().for_each(|(kind, body)| put(*kind, body, &mut bytes));
        client.receive(&bytes).unwrap_err().to_string()
    };
    let (v, c) = ((Kind::ProtocolVersion, &[1u8][..]), (Kind::ControllerVersion, &[0u8; 16][..]));
    assert!(told(&[(Kind::ProtocolVersion, &[0])]).contains("does not speak protocol 2"));
    assert!(told(&[c]).contains("where that has no place"));
    assert!(told(&[v, c, (Kind::SetupOutputs, b"\x01")]).contains("0 types for 1"));
    let other = told(&[v, c, (Kind::SetupOutputs, b"\x01INT32")]);
    assert!(other.contains("timestamp as INT32, where RTDE has DOUBLE"), "{other}");
    assert!(told(&[v, c, (Kind::SetupOutputs, b"\x01FLOAT")]).contains("none of RTDE's"));
    let agreed = [v, c, (Kind::SetupOutputs, &b"\x01DOUBLE"[..])];
    assert!(told(&[&agreed[..], &[(Kind::Start, &[0])]].concat()).contains("refused to start"));
    let runs = [&agreed[..], &[(Kind::Start, &[1][..])]].concat();
    let foreign = [&runs[..], &[(Kind::Data, &b"\x02abcdefgh"[..])]].concat();
    assert!(told(&foreign).contains("of the recipe 2, 1 was agreed on"));
    let short = [&runs[..], &[(Kind::Data, &b"\x01abcdefg"[..])]].concat();
    assert!(told(&short).contains("has 8 bytes, 9 were expected"));
}

/// Who announces much and sends little keeps no more than one package waiting.
#[test]
fn what_is_announced_is_not_made_room_for() {
    let mut framer = Framer::default();
    framer.push(b"\xff\xffM");
    for _ in 0..100_000 {
        framer.push(&[0; 7]);
        while framer.next_frame().unwrap_or_default().is_some() {}
        if framer.next_frame().is_err() {
            break;
        }
        assert!(framer.waiting() < 65536);
    }
}

#[test]
fn garbage_is_an_error_and_never_a_panic() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for round in 0..3000 {
        let length = rng.random_range(0..200);
        let mut bytes: Vec<u8> = (0..length).map(|_| rng.random()).collect();
        // Half of it looks like a package, so that bodies are read too.
        if round % 2 == 0 && bytes.len() > 3 {
            let kinds = b"VvMUOISP";
            let size = bytes.len() as u16;
            bytes[..2].copy_from_slice(&size.to_be_bytes());
            bytes[2] = kinds[rng.random_range(0..kinds.len())];
        }
        let mut session = Session::new(offer());
        let _ = session.receive(&bytes);
        let mut client = Client::new(wish(&FIELDS, &[]));
        let mut fresh = Session::new(offer());
        if round % 3 == 0 {
            talk(&mut client, &mut fresh, 999).unwrap();
        }
        let _ = client.receive(&bytes);
    }
}
