//! Foxglove: the messages of its WebSocket protocol, as far as this server speaks it (subprotocols `foxglove.sdk.v1` and,
//! for older programs, `foxglove.websocket.v1`, whose messages here are the same).

use dermatome_messages::{
    Topic, schema,
    topic::{ENCODING, SCHEMA_ENCODING},
};
use serde::Deserialize;
use serde_json::{Value, json};

/// Subprotocols, the best first.
pub(crate) const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/// Something that a client can ask for, in JSON both ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Service {
    /// Its name: `/dermatome/tare`.
    pub name: &'static str,
    /// JSON schema of the request.
    pub request: &'static str,
}

/// What clients say in text; what this server does not know is no error.
#[derive(Debug, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
pub(crate) enum Said {
    Subscribe {
        subscriptions: Vec<Subscription>,
    },
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        subscription_ids: Vec<u32>,
    },
    #[serde(other)]
    Other,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Subscription {
    pub(crate) id: u32,
    pub(crate) channel_id: u64,
}

/// A client's request to a service.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Request {
    pub(crate) service: u32,
    pub(crate) call: u32,
    pub(crate) encoding: String,
    pub(crate) payload: Vec<u8>,
}

/// What clients subscribe to: a topic of one of the spaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Channel {
    /// Number of the space.
    space: usize,
    topic: Topic,
}

impl Channel {
    /// Of a topic in a space; what all spaces tell under one name is told in the first.
    pub(crate) fn new(space: usize, topic: Topic) -> Self {
        Self { space: if topic.is_shared() { 0 } else { space }, topic }
    }

    /// Its number among all channels, space by space, from 0.
    pub(crate) fn index(self) -> usize {
        self.space * Topic::ALL.len() + self.topic.index()
    }
}

/// The channel that a client names, where there are so many spaces; clients count from 1.
pub(crate) fn channel_of(id: u64, spaces: usize) -> Option<Channel> {
    let index = usize::try_from(id.checked_sub(1)?).ok()?;
    let (space, topic) = (index / Topic::ALL.len(), index % Topic::ALL.len());
    let channel = Channel::new(space, Topic::ALL[topic]);
    (space < spaces && channel.space == space).then_some(channel)
}

pub(crate) fn server_info(name: &str, session: &str) -> String {
    json!({
        "op": "serverInfo",
        "name": name,
        "capabilities": ["services"],
        "supportedEncodings": ["json"],
        "metadata": {},
        "sessionId": session,
    })
    .to_string()
}

pub(crate) fn advertise(spaces: &[String], is_robot: bool) -> String {
    let channels: Vec<Value> = (0..spaces.len())
        .flat_map(|space| Topic::ALL.map(|topic| (space, topic)))
        .filter(|(space, topic)| *space == 0 || !topic.is_shared())
        .filter(|(_, topic)| is_robot || !topic.is_of_robot())
        .map(|(space, topic)| advertisement(Channel::new(space, topic), &spaces[space]))
        .collect();
    json!({ "op": "advertise", "channels": channels }).to_string()
}

fn advertisement(channel: Channel, space: &str) -> Value {
    let topic = channel.topic;
    json!({
        "id": channel.index() + 1,
        "topic": topic.name_in(space),
        "encoding": ENCODING,
        "schemaName": topic.schema().name,
        "schema": schema::definition(topic.schema()),
        "schemaEncoding": SCHEMA_ENCODING,
    })
}

pub(crate) fn advertise_services(services: &[Service], spaces: &[String]) -> String {
    let response = json!({ "type": "object" }).to_string();
    let all = spaces.iter().flat_map(|space| services.iter().map(move |service| (space, service)));
    let about = |(id, (space, service)): (usize, (&String, &Service))| {
        let name = service.name.replacen("dermatome", space, 1);
        // Programs know schemas by their names.
        let part = |kind: &str, schema: &str| json!({ "encoding": "json", "schemaName": format!("{name}_{kind}"), "schemaEncoding": "jsonschema", "schema": schema });
        json!({
            "id": id,
            "name": name,
            "type": service.name,
            "request": part("Request", service.request),
            "response": part("Response", &response),
        })
    };
    let services: Vec<Value> = all.enumerate().map(about).collect();
    json!({ "op": "advertiseServices", "services": services }).to_string()
}

pub(crate) fn failure(service: u32, call: u32, message: &str) -> String {
    json!({ "op": "serviceCallFailure", "serviceId": service, "callId": call, "message": message })
        .to_string()
}

pub(crate) fn warning(message: &str) -> String {
    json!({ "op": "status", "level": 1, "message": message }).to_string()
}

/// What stands before a message's own bytes.
pub(crate) fn message_head(subscription: u32, log_time: u64) -> [u8; 13] {
    let mut head = [1; 13];
    head[1..5].copy_from_slice(&subscription.to_le_bytes());
    head[5..].copy_from_slice(&log_time.to_le_bytes());
    head
}

pub(crate) fn response(service: u32, call: u32, payload: &[u8]) -> Vec<u8> {
    let encoding = b"json";
    let numbers = [service, call, encoding.len() as u32].map(u32::to_le_bytes);
    [&[3], numbers.as_flattened(), encoding, payload].concat()
}

/// A request to a service; none if the bytes are something else.
pub(crate) fn request(bytes: &[u8]) -> Option<Request> {
    let (2, rest) = bytes.split_first().map(|(op, rest)| (*op, rest))? else { return None };
    let number = |at: usize| Some(u32::from_le_bytes(rest.get(at..at + 4)?.try_into().ok()?));
    let (service, call, length) = (number(0)?, number(4)?, number(8)? as usize);
    let rest = rest.get(12..)?;
    let encoding = std::str::from_utf8(rest.get(..length)?).ok()?.to_owned();
    Some(Request { service, call, encoding, payload: rest[length..].to_vec() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_is_read_and_half_of_one_is_not() {
        let bytes = [&[2, 3, 0, 0, 0, 7, 0, 0, 0, 4, 0, 0, 0][..], b"json{}"].concat();
        let read = request(&bytes).unwrap();
        assert_eq!((read.service, read.call, read.encoding.as_str()), (3, 7, "json"));
        assert_eq!(read.payload, b"{}");
        for length in 0..bytes.len() - 2 {
            assert_eq!(request(&bytes[..length]), None, "{length}");
        }
        let endless = [2, 3, 0, 0, 0, 7, 0, 0, 0, 255, 255, 255, 255];
        assert_eq!(request(&endless), None);
    }

    #[test]
    fn what_clients_say_is_read_and_what_is_not_known_is_no_error() {
        let text = r#"{"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]}"#;
        assert!(matches!(serde_json::from_str(text), Ok(Said::Subscribe { .. })));
        let text = r#"{"op":"unsubscribe","subscriptionIds":[5]}"#;
        assert!(matches!(serde_json::from_str(text), Ok(Said::Unsubscribe { .. })));
        assert!(matches!(serde_json::from_str(r#"{"op":"getParameters","id":"x"}"#), Ok(Said::Other)));
        assert_eq!(channel_of(1, 1), Some(Channel::new(0, Topic::ALL[0])));
        assert_eq!((channel_of(0, 1), channel_of(99, 2)), (None, None));
        let all = 1..=2 * Topic::ALL.len() as u64;
        assert!(
            all.clone().all(|id| channel_of(id, 2).is_none_or(|channel| channel.index() as u64 + 1 == id))
        );
        let shared = Topic::ALL.into_iter().filter(|topic| topic.is_shared()).count();
        assert_eq!(all.filter(|id| channel_of(*id, 2).is_none()).count(), shared);
    }

    #[test]
    fn no_topic_and_no_schema_is_advertised_twice() {
        let spaces = ["arm/palm".to_owned(), "arm/back".to_owned()];
        let names = |text: &str, list: &str, path: &[&str]| -> Vec<String> {
            let value: Value = serde_json::from_str(text).unwrap();
            let each = value[list].as_array().unwrap().iter();
            let name = |it: &Value| path.iter().fold(it, |it, key| &it[*key]).as_str().unwrap().to_owned();
            let mut names: Vec<String> = each.map(name).collect();
            names.sort();
            names
        };
        let distinct = |names: &[String]| names.is_sorted_by(|a, b| a < b);
        for is_robot in [false, true] {
            let topics = names(&advertise(&spaces, is_robot), "channels", &["topic"]);
            assert!(distinct(&topics) && topics.contains(&"/tf_static".to_owned()), "{topics:?}");
            assert_eq!(topics.contains(&"/tf".to_owned()), is_robot);
        }
        let services = ["/dermatome/tare", "/dermatome/drive"].map(|name| Service { name, request: "{}" });
        let text = advertise_services(&services, &spaces);
        assert!(distinct(&names(&text, "services", &["request", "schemaName"])), "{text}");
    }
}
