//! `dermatome view`: its server, as programs of others meet it. The page itself is tested in a browser
//! (host/page/web/tests).

mod program;
mod testbench;

use dermatome::simulate::board::{BoardOptions, SimulatedBoard};
use dermatome_messages::{
    Topic, cdr,
    dermatome::{ContactArray, Image, Skin, Status},
    standard::{DiagnosticArray, MarkerArray},
};
use program::{Desk, Running, TINY};
use serde_json::{Value, json};
use std::{
    collections::HashMap,
    io::{Read, Write},
    net::TcpStream,
    time::{Duration, Instant},
};
use testbench::{Held, Pressed, small_patch};
use tungstenite::{
    Message, WebSocket, client::IntoClientRequest, handshake::client::Response, http::HeaderValue,
};

/// A program that looks on.
struct Client {
    socket: WebSocket<TcpStream>,
    /// Channels by their topics.
    channels: HashMap<String, u64>,
    services: HashMap<String, u64>,
}

/// Shakes hands with the server at `address`, as a page of `origin` would.
fn shake(
    address: &str,
    query: &str,
    origin: Option<&str>,
    protocol: &str,
) -> Result<(WebSocket<TcpStream>, Response), String> {
    let mut request = format!("ws://{address}/{query}").into_client_request().unwrap();
    let headers = request.headers_mut();
    headers.insert("sec-websocket-protocol", HeaderValue::from_str(protocol).unwrap());
    if let Some(origin) = origin {
        headers.insert("origin", HeaderValue::from_str(origin).unwrap());
    }
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    tungstenite::client(request, stream).map_err(|error| error.to_string())
}

impl Client {
    fn connect(address: &str) -> Self {
        let (socket, response) = shake(address, "", None, "foxglove.sdk.v1").unwrap();
        assert_eq!(response.headers()["sec-websocket-protocol"], "foxglove.sdk.v1");
        let mut client = Self { socket, channels: HashMap::new(), services: HashMap::new() };
        while client.services.is_empty() {
            client.hear();
        }
        client
    }

    /// The next message: text is taken in, binary is given.
    fn hear(&mut self) -> Option<Vec<u8>> {
        match self.socket.read().unwrap() {
            Message::Text(text) => {
                let said: Value = serde_json::from_str(&text).unwrap();
                let ids = |list: &Value, name: &str| -> HashMap<String, u64> {
                    let pair =
                        |one: &Value| (one[name].as_str().unwrap().to_owned(), one["id"].as_u64().unwrap());
                    list.as_array().unwrap().iter().map(pair).collect()
                };
                match said["op"].as_str().unwrap() {
                    "advertise" => self.channels = ids(&said["channels"], "topic"),
                    "advertiseServices" => self.services = ids(&said["services"], "name"),
                    _ => {}
                }
                None
            }
            Message::Binary(bytes) => Some(bytes.to_vec()),
            _ => None,
        }
    }

    /// Subscribes to a topic, under the number of its channel.
    fn subscribe(&mut self, topic: Topic) -> u32 {
        self.subscribe_to(topic.name())
    }

    fn subscribe_to(&mut self, name: &str) -> u32 {
        let channel = self.channels[name];
        let text = json!({ "op": "subscribe", "subscriptions": [{ "id": channel, "channelId": channel }] });
        self.socket.send(Message::text(text.to_string())).unwrap();
        channel as u32
    }

    /// The next message of a subscription that is as wanted.
    fn next<M: serde::de::DeserializeOwned>(
        &mut self,
        subscription: u32,
        is_wanted: impl Fn(&M) -> bool,
    ) -> M {
        let started = Instant::now();
        loop {
            assert!(started.elapsed() < Duration::from_secs(60), "no such message");
            let Some(bytes) = self.hear().filter(|bytes| bytes[0] == 1) else { continue };
            if bytes[1..5] == subscription.to_le_bytes() {
                let message = cdr::decode(&bytes[13..]).unwrap();
                if is_wanted(&message) {
                    return message;
                }
            }
        }
    }

    fn call(&mut self, service: &str, request: &Value) -> Value {
        let numbers = [self.services[service] as u32, 77, 4].map(u32::to_le_bytes);
        let bytes = [&[2][..], numbers.as_flattened(), b"json", request.to_string().as_bytes()].concat();
        self.socket.send(Message::binary(bytes)).unwrap();
        loop {
            let Some(bytes) = self.hear().filter(|bytes| bytes[0] == 3) else { continue };
            assert_eq!(bytes[5..9], 77_u32.to_le_bytes());
            return serde_json::from_slice(&bytes[17..]).unwrap();
        }
    }
}

/// The program, and its address.
fn view(desk: &Desk, more: &[&str]) -> (Running, String) {
    let mut view = desk.start(&[&["view", "--listen", "127.0.0.1:0", "--no-browser"], more].concat());
    let line = view.line();
    let address = line.trim().strip_prefix("http://").and_then(|rest| rest.strip_suffix('/'));
    let address = address.unwrap_or_else(|| panic!("{line}")).to_owned();
    (view, address)
}

fn get(address: &str, head: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(head.as_bytes()).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
fn a_program_sees_skin_images_contacts_and_status_and_tares() {
    let desk = Desk::with_patch();
    let (_view, address) = view(&desk, &["--port", "sim:skin.toml"]);
    let mut client = Client::connect(&address);
    let skin = client.subscribe(Topic::Skin);
    let status = client.subscribe(Topic::Status);
    let skin: Skin = client.next(skin, |skin: &Skin| !skin.vertices.is_empty());
    assert_eq!((skin.name.as_str(), skin.electrodes.len()), ("tiny", 3 * 8));
    assert_eq!(skin.vertices.len(), 3 * skin.vertex_pixels.len());
    let live: Status = client.next(status, |status: &Status| status.state == "live");
    assert_eq!((live.board.as_str(), live.skin.as_str(), live.frequency), ("simulated", "tiny", 50e3));
    let (image, contacts) = (client.subscribe(Topic::Image), client.subscribe(Topic::Contacts));
    let image: Image = client.next(image, |_| true);
    assert_eq!(image.mantissas.len(), skin.pixel_areas.len());
    let touched = |array: &ContactArray| !array.contacts.is_empty();
    let touch: ContactArray = client.next(contacts, touched);
    assert!(touch.contacts[0].strength > 0.05 && touch.stamp.header.frame_id == "tiny");
    let known = |status: &Status| status.signal_to_noise > 0.0;
    let noise: Status = client.next(status, known);
    assert!((40.0..90.0).contains(&noise.signal_to_noise), "{}", noise.signal_to_noise);
    assert_eq!(client.call("/dermatome/tare", &json!({})), json!({ "ok": true }));
    client.next(status, known);
}

#[test]
fn drive_threshold_and_patches_change_what_is_seen() {
    let desk = Desk::with_patch();
    let smooth = TINY.replace("hyperparameter = 0.03", "hyperparameter = 0.3");
    desk.write("smooth.toml", smooth.replace("[contact]", "[contact]\nfound_in = \"image\""));
    desk.run(&["build", "smooth.toml", "-o", "smooth.dermatome"]).success();
    let (_view, address) = view(&desk, &["--port", "sim:skin.toml", "--patch", "smooth.dermatome"]);
    let mut client = Client::connect(&address);
    let status = client.subscribe(Topic::Status);
    let live: Status = client.next(status, |status: &Status| status.state == "live");
    assert_eq!(live.patches, ["tiny (on the board)", "smooth"]);
    let changed = client.call("/dermatome/drive", &json!({ "amplitude_ma": 0.5, "gain": 2 }));
    assert_eq!(changed, json!({ "ok": true }));
    let driven: Status = client.next(status, |status: &Status| status.gain == 2 && status.state == "live");
    assert!((driven.amplitude - 0.5e-3).abs() < 1e-9);
    for (service, request, words) in [
        ("/dermatome/drive", json!({ "amplitude_ma": 1e9 }), "cannot drive"),
        ("/dermatome/drive", json!({ "gain": 3 }), "gain"),
        ("/dermatome/drive", json!({ "voltage": 3 }), "voltage"),
        ("/dermatome/patch", json!({ "index": 2 }), "allowed: 0 to 1"),
        ("/dermatome/threshold", json!({ "value": -1 }), "allowed"),
        ("/dermatome/scope", json!({ "slot": 9999 }), "allowed"),
        ("/dermatome/record", json!({ "start": false }), "nothing is being recorded"),
        ("/dermatome/calibrate", json!({ "readings": [] }), "readings"),
    ] {
        let answer = client.call(service, &request);
        let error = answer["error"].as_str().unwrap_or_default();
        assert!(answer["ok"] == false && error.contains(words), "{service} {request}: {answer}");
    }
    let contacts = client.subscribe(Topic::Contacts);
    let strong: ContactArray = client.next(contacts, |array: &ContactArray| !array.contacts.is_empty());
    assert_eq!(client.call("/dermatome/patch", &json!({ "index": 1 })), json!({ "ok": true }));
    let chosen: Status = client.next(status, |status: &Status| status.patch == 1);
    assert_eq!(chosen.state, "live");
    let weak: ContactArray = client.next(contacts, |array: &ContactArray| !array.contacts.is_empty());
    let strength = |array: &ContactArray| array.contacts[0].strength;
    assert!((strength(&weak) - strength(&strong)).abs() > 0.001, "{} {}", strength(&weak), strength(&strong));
    assert_eq!(client.call("/dermatome/threshold", &json!({ "value": 50.0 })), json!({ "ok": true }));
    client.next(contacts, |array: &ContactArray| array.contacts.is_empty());
}

#[test]
fn a_recording_is_started_and_stopped_and_replayed_bit_for_bit() {
    let desk = Desk::with_patch();
    let (_view, address) = view(&desk, &["--port", "sim:skin.toml"]);
    let mut client = Client::connect(&address);
    let status = client.subscribe(Topic::Status);
    client.next(status, |status: &Status| status.state == "live");
    let started = client.call("/dermatome/record", &json!({ "start": true }));
    assert_eq!((&started["ok"], &started["file"]), (&true.into(), &"tiny-1.mcap".into()), "{started}");
    let recorded: Status = client.next(status, |status: &Status| status.recorded_frames > 60);
    assert!(recorded.recording == "tiny-1.mcap" && recorded.recorded_bytes > 1000);
    let stopped = client.call("/dermatome/record", &json!({ "start": false }));
    assert!(stopped["frames"].as_u64() > Some(60), "{stopped}");
    let done = desk.run(&["replay", "tiny-1.mcap"]).success();
    assert!(done.err.contains("bit for bit"), "{}", done.err);
    assert_eq!(client.call("/dermatome/check", &json!({}))["findings"], json!([]));
    client.next(status, |status: &Status| status.state == "live");
}

#[test]
fn a_board_that_is_not_there_is_waited_for_and_one_that_goes_is_told() {
    let desk = Desk::with_patch();
    let (board, port) = desk.board("skin.toml", &[]);
    let listen = port.clone();
    drop(board);
    let (_view, address) = view(&desk, &["--port", &port]);
    let mut client = Client::connect(&address);
    let status = client.subscribe(Topic::Status);
    let told: Status =
        client.next(status, |status: &Status| status.state == "no_board" && !status.text.is_empty());
    assert!(told.text.contains(&port) && !told.advice.is_empty(), "{told:?}");
    let refused = client.call("/dermatome/tare", &json!({}));
    assert_eq!(refused["ok"], false, "{refused}");
    let board = desk.start(&["simulate", "skin.toml", "--listen", &listen]);
    let told: Status = client.next(status, |status: &Status| status.state == "no_patch");
    assert!(told.advice.contains("dermatome flash"), "{told:?}");
    drop(board);
    let store = ["--store", "board.dermatome"];
    std::fs::copy(desk.path("skin.dermatome"), desk.path("board.dermatome")).unwrap();
    let board = desk.start(&[&["simulate", "skin.toml", "--listen", &listen], &store[..]].concat());
    client.next(status, |status: &Status| status.state == "live");
    let (markers, diagnostics) = (client.subscribe(Topic::Markers), client.subscribe(Topic::Diagnostics));
    client.next(markers, |array: &MarkerArray| array.markers.len() > 1);
    drop(board);
    // Programs that draw frames are told that they are over.
    client.next(markers, |array: &MarkerArray| matches!(&array.markers[..], [clear] if clear.action == 3));
    let said: DiagnosticArray =
        client.next(diagnostics, |array: &DiagnosticArray| array.status[0].level == 2);
    let told: Status = client.next(status, |status: &Status| status.state == "lost");
    assert!(!told.text.is_empty() && said.status[0].message == told.text);
    let _board = desk.start(&[&["simulate", "skin.toml", "--listen", &listen], &store[..]].concat());
    client.next(status, |status: &Status| status.state == "live");
}

#[test]
fn pages_of_others_and_other_names_stay_out_and_other_computers_need_a_token() {
    let desk = Desk::with_patch();
    let more = ["--port", "sim:skin.toml", "--allow-origin", "https://app.foxglove.dev"];
    let (_view, address) = view(&desk, &more);
    let own = format!("http://{address}");
    for (origin, comes_in) in [
        (None, true),
        (Some(own.as_str()), true),
        (Some("https://app.foxglove.dev"), true),
        (Some("http://evil.example"), false),
        (Some("file://"), false),
        (Some("null"), false),
    ] {
        let shaken = shake(&address, "", origin, "foxglove.sdk.v1");
        assert_eq!(shaken.is_ok(), comes_in, "{origin:?}: {:?}", shaken.err());
    }
    assert!(shake(&address, "", None, "foxglove.websocket.v1").is_ok(), "older programs");
    assert!(shake(&address, "", None, "chat").is_err());
    let (_open, to_files) = view(&desk, &["--port", "sim:skin.toml", "--allow-origin", "file://"]);
    assert!(shake(&to_files, "", Some("file://"), "foxglove.sdk.v1").is_ok());
    let page = get(&address, &format!("GET / HTTP/1.1\r\nHost: {address}\r\n\r\n"));
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("Content-Security-Policy"), "{page}");
    let stranger = get(&address, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n");
    assert!(stranger.starts_with("HTTP/1.1 403"), "{stranger}");
    let none = get(&address, &format!("GET /../skin.toml HTTP/1.1\r\nHost: {address}\r\n\r\n"));
    assert!(none.starts_with("HTTP/1.1 404"), "{none}");
    let words = desk.run(&["view", "--listen", "0.0.0.0:0", "--no-browser"]).refused();
    assert!(words.contains("--allow-remote"), "{words}");
    let remote = ["view", "--listen", "0.0.0.0:0", "--allow-remote", "--token", "abcdefgh", "--no-browser"];
    let mut remote = desk.start(&remote);
    let line = remote.line();
    let address = line.trim().strip_prefix("http://").and_then(|rest| rest.strip_suffix("/?token=abcdefgh"));
    let address = address.unwrap_or_else(|| panic!("{line}")).replace("0.0.0.0", "127.0.0.1");
    assert!(shake(&address, "", None, "foxglove.sdk.v1").is_err(), "without the token");
    assert!(shake(&address, "?token=abcdefgi", None, "foxglove.sdk.v1").is_err());
    assert!(shake(&address, "?token=abcdefgh", None, "foxglove.sdk.v1").is_ok());
}

#[test]
fn a_client_that_sends_rubbish_harms_nobody() {
    let desk = Desk::with_patch();
    let (mut view, address) = view(&desk, &["--port", "sim:skin.toml"]);
    let mut rude = Client::connect(&address);
    for message in [
        Message::text("{"),
        Message::text("{\"op\":\"subscribe\"}"),
        Message::text("{\"op\":\"subscribe\",\"subscriptions\":[{\"id\":1,\"channelId\":999}]}"),
        Message::binary(vec![2, 1]),
        Message::binary(vec![2; 40]),
        Message::binary(vec![0; 0]),
    ] {
        rude.socket.send(message).unwrap();
    }
    let mut other = TcpStream::connect(&address).unwrap();
    other.write_all(b"\x16\x03\x01 another protocol\r\n\r\n").unwrap();
    let mut client = Client::connect(&address);
    let status = client.subscribe(Topic::Status);
    client.next(status, |status: &Status| status.state == "live");
    assert!(view.is_running());
}

#[test]
fn a_board_that_comes_back_pressed_gets_no_reference_until_it_is_free_or_one_is_asked_for() {
    for (scans, is_asked) in [(60, false), (u32::MAX, true)] {
        let desk = Desk::empty();
        let options = BoardOptions { patch: Some(small_patch("small", 50.0)), ..BoardOptions::default() };
        let first = SimulatedBoard::start(options.clone(), Pressed::new(1)).unwrap();
        let at = first.address();
        let (_view, address) = view(&desk, &["--port", &format!("tcp:{at}")]);
        let mut client = Client::connect(&address);
        let status = client.subscribe(Topic::Status);
        // The reference is read once it is made.
        client.next(status, |status: &Status| status.state == "live" && status.frames > 40);
        first.stop().unwrap();
        let options = BoardOptions { listen: at, ..options };
        let _second = SimulatedBoard::start(options, Held::new(scans)).unwrap();
        let told = client.next(status, |status: &Status| status.state == "not_tared");
        assert!(told.text.contains("something presses on the skin"), "{told:?}");
        if is_asked {
            assert_eq!(client.call("/dermatome/tare", &json!({}))["ok"], true);
        }
        client.next(status, |status: &Status| status.state == "live");
    }
}

#[test]
fn a_robot_s_skins_have_a_space_each() {
    let desk = Desk::with_patch();
    desk.write("other.toml", TINY.replace("name = \"tiny\"", "name = \"other\""));
    let patch = |name: &str, file: &str| {
        format!(
            "[[patches]]\nname = \"{name}\"\nskin = \"{file}\"\nport = \"sim:{file}\"\nlink = \"{name}_link\"\n\
             position = [\"0 mm\", \"0 mm\", \"40 mm\"]\norientation = [0, 0, 0, 1]\n"
        )
    };
    let text = format!("name = \"arm\"\n{}{}", patch("palm", "skin.toml"), patch("elbow", "other.toml"));
    desk.write("robot.toml", text);
    // A port that was free a moment ago.
    let listen = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let mut serve = desk.start(&["serve", "robot.toml", "--listen", &listen.to_string(), "--no-browser"]);
    serve.read_output();
    let started = Instant::now();
    while TcpStream::connect(listen).is_err() {
        assert!(started.elapsed() < program::LIMIT && serve.is_running());
        std::thread::sleep(Duration::from_millis(10));
    }
    let mut client = Client::connect(&listen.to_string());
    let skins = [("palm", "tiny"), ("elbow", "other")];
    for (patch, name) in skins {
        let (skin, contacts) = (format!("/arm/{patch}/skin"), format!("/arm/{patch}/contacts"));
        let (skin, contacts) = (client.subscribe_to(&skin), client.subscribe_to(&contacts));
        let skin: Skin = client.next(skin, |_| true);
        assert_eq!((skin.name.as_str(), skin.header.frame_id), (name, format!("{patch}_link")));
        let array: ContactArray = client.next(contacts, |array: &ContactArray| !array.contacts.is_empty());
        assert!((array.contacts[0].position.z - 0.04).abs() < 1e-6, "{array:?}");
    }
    let status = client.subscribe_to("/arm/elbow/status");
    client.next(status, |status: &Status| status.state == "live");
    assert_eq!(client.call("/arm/elbow/tare", &json!({}))["ok"], true);
    let drive = client.call("/arm/palm/drive", &json!({ "amplitude_ma": -1 }));
    assert!(drive["error"].as_str().unwrap().contains("allowed"), "{drive}");
    assert!(!client.services.contains_key("/arm/palm/record"));
}
