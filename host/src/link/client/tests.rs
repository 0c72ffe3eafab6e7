use std::io::{Read, Write};

use inm_protocol::{Decoder, Fault, Health, ToHost};

use super::*;

/// Hands out these reads, one after the other.
struct Reads(Vec<Vec<u8>>);

impl Read for Reads {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        if self.0.is_empty() {
            return Err(ErrorKind::TimedOut.into());
        }
        let bytes = self.0.remove(0);
        buf[..bytes.len()].copy_from_slice(&bytes);
        Ok(bytes.len())
    }
}

impl Write for Reads {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        Ok(buf.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn frame(message: &ToHost) -> Vec<u8> {
    let mut frame = [0; MAX_FRAME];
    let len = encode(message, &mut frame).expect("every message has room");
    frame[..len].to_vec()
}

/// A board at rest sends health records. Where one of them shares its reads with a reply, a
/// decoder that begins behind the reply must not begin in the middle of it.
#[test]
fn the_numbers_of_commands_begin_at_random() {
    let ids: std::collections::HashSet<u16> = (0..64).map(|_| first_id()).collect();
    assert!(ids.len() > 32, "{ids:?}");
    assert!(ids.iter().all(|id| FIRST_IDS.contains(id)), "{ids:?}");
}

/// The number of a start is that of its stream: none twice in a record, and none is 0.
#[test]
fn numbers_go_on_behind_another_client_and_leave_0_out() {
    let client = || {
        Client::new(
            Box::new(Reads(Vec::new())),
            "port".into(),
            Patience::default(),
        )
    };
    let mut first = client();
    first.next_id = u16::MAX - 1;
    assert_eq!([first.number(), first.number()], [u16::MAX - 1, u16::MAX]);
    let mut second = client().behind(&first);
    assert_eq!([second.number(), second.number()], [1, 2]);
}

#[test]
fn what_is_behind_a_reply_waits_for_the_next_read() {
    let health = frame(&ToHost::Health(Health::default()));
    let reply = |id| {
        frame(&ToHost::Reply(Reply {
            id,
            result: Ok(Answer::Done),
        }))
    };
    for cut in 1..health.len() {
        let (early, late) = health.split_at(cut);
        let reads = vec![
            [&health, &reply(1)[..], early].concat(),
            [late, &reply(2), early].concat(),
            late.to_vec(),
        ];
        let mut client = Client::new(
            Box::new(Reads(reads)),
            "a board".to_owned(),
            Patience::default(),
        );
        client.next_id = 1;
        let mut kinds = String::new();
        for _ in 0..2 {
            let mut decoder = Decoder::<MAX_FRAME>::new();
            let answer = client.request(Request::Stop, |mut bytes, id| {
                let mut found = None;
                while let Some(message) = decoder.next::<ToHost>(&mut bytes) {
                    match message.expect("nothing is damaged") {
                        ToHost::Reply(reply) if reply.id == id => found = Some(reply),
                        _ => kinds.push('h'),
                    }
                }
                Ok::<_, LinkError>(found)
            });
            assert_eq!(answer.ok(), Some(Answer::Done), "cut at {cut}");
            assert_eq!(decoder.pending(), 0, "cut at {cut}");
            kinds.push('r');
        }
        let mut rest = Vec::new();
        let mut buf = [0; 4096];
        loop {
            match client.read(&mut buf).expect("the port stays") {
                0 => break,
                len => rest.extend_from_slice(&buf[..len]),
            }
        }
        let mut decoder = Decoder::<MAX_FRAME>::new();
        let last: Option<Result<ToHost, Fault>> = decoder.next(&mut &rest[..]);
        assert!(matches!(last, Some(Ok(ToHost::Health(_)))), "cut at {cut}");
        assert_eq!(kinds, "hrhr", "cut at {cut}");
    }
}

#[test]
fn the_waits_are_those_that_the_wire_documents() {
    const WIRE: &str = include_str!("../../../../protocol/WIRE.md");
    let Patience {
        wait,
        tries,
        silence,
    } = Patience::default();
    for row in [
        format!("| wait for a reply | {} ms | host |", wait.as_millis()),
        format!("the same number each time | {tries} | host |"),
        format!("looks for it anew | {} s | host |", silence.as_secs()),
    ] {
        assert!(WIRE.contains(&row), "{row}");
    }
}
