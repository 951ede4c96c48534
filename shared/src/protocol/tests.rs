use super::*;
use crate::contact::Contact;
use crate::limits::MAX_CONTACTS;
use proptest::prelude::*;

#[test]
fn the_longest_messages_fit_a_packet() {
    let at = FrameStamp { sequence: u32::MAX, timestamp_us: u64::MAX, flags: FrameFlags(u16::MAX) };
    let contact = Contact {
        position: [0.1; 3],
        normal: [0.1; 3],
        area: 0.1,
        strength: 0.1,
        peak: 0.1,
        pressure: Some(0.1),
        load_area: Some(0.1),
        evidence: None,
        identity: None,
    };
    let image = PackedImage { exponent: -1, mantissas: (0..MAX_PIXELS).map(|_| i16::MIN).collect() };
    let codes: Vec<AdcCode, MAX_STEPS> = (0..MAX_STEPS).map(|_| AdcCode(i32::MIN)).collect();
    let events = [
        Event::Image { at, image },
        Event::Contacts { at, contacts: (0..MAX_CONTACTS).map(|_| contact).collect() },
        Event::Measurements { at, codes: codes.clone(), quadrature: codes },
        Event::Scope(SlotSamples {
            slot: u16::MAX,
            gain: 64,
            settling: 9999,
            samples: (0..MAX_SCOPE_SAMPLES).map(|_| 4095).collect(),
        }),
    ];
    for event in events {
        let mut buffer = [0; MAX_PACKET_BYTES];
        encode(&BoardPacket::Event { number: u32::MAX, event }, &mut buffer).unwrap();
    }
}

/// Hello must stay readable by every version there will ever be: these bytes never change.
#[test]
fn hello_keeps_its_bytes_for_ever() {
    let version = Version { protocol: 1, schema: [1, 2, 3, 4, 5, 6, 7, 8] };
    let request = RequestPacket { sequence: 2, request: Request::Hello(version) };
    let mut buffer = [0; 64];
    assert_eq!(postcard::to_slice(&request, &mut buffer).unwrap(), [2, 0, 1, 1, 2, 3, 4, 5, 6, 7, 8]);
    let identity =
        Identity { board: String::try_from("b").unwrap(), firmware: String::try_from("f").unwrap() };
    let reply = BoardPacket::Reply { sequence: 2, reply: Reply::Hello { version, identity } };
    let expected = [0, 2, 0, 1, 1, 2, 3, 4, 5, 6, 7, 8, 1, b'b', 1, b'f'];
    assert_eq!(postcard::to_slice(&reply, &mut buffer).unwrap(), expected);
    let refused = Reply::Refused(Refusal::Version { board: 1 });
    let reply = BoardPacket::Reply { sequence: 2, reply: refused };
    assert_eq!(postcard::to_slice(&reply, &mut buffer).unwrap(), [0, 2, 1, 0, 1]);
}

/// Found by the fuzz target `patch`.
#[test]
fn an_image_at_the_ends_of_its_range_packs_to_half_a_step() {
    let image: Image = [i32::MIN, i32::MAX, 952_684_032, 0].into_iter().map(RelativeConductivity).collect();
    let packed = PackedImage::pack(&image);
    assert_eq!(packed.exponent, 3);
    for (value, exact) in packed.values().zip(&image) {
        assert!((value - exact.to_f64()).abs() <= 0.0625, "{value} for {exact:?}");
    }
}

proptest! {
    #[test]
    fn no_message_bytes_make_the_decoder_panic(message in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = postcard::from_bytes::<RequestPacket>(&message);
        let _ = postcard::from_bytes::<BoardPacket>(&message);
    }

    #[test]
    fn packing_an_image_keeps_it_to_half_a_step(
        values in prop::collection::vec(any::<i32>(), 1..50),
        shift in 0_u32..31,
    ) {
        let image: Image = values.iter().map(|value| RelativeConductivity(value >> shift)).collect();
        let packed = PackedImage::pack(&image);
        let largest = image.iter().map(|value| value.to_f64().abs()).fold(0.0, f64::max);
        let half_step = 0.5 / f64::from(packed.exponent).exp2();
        prop_assert!(packed.exponent == 20 || half_step <= largest / 32_000.0);
        for (value, back) in image.iter().zip(packed.values()) {
            prop_assert!((value.to_f64() - back).abs() <= half_step + 1e-12);
        }
    }
}

/// A change of the hash is a new version.
#[test]
fn the_messages_of_this_version_have_their_schema_hash() {
    let schema = std::format!("{:02x?}", Version::current().schema);
    assert_eq!((PROTOCOL_VERSION, schema.as_str()), (14, "[26, 23, e7, ae, 10, 51, ef, 7e]"));
}
