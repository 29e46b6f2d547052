//! Encoded messages are decoded unchanged, for every topic; invalid bytes are rejected.

use std::convert::Infallible;

use ipc_types::cdr::{self, DecodeError};
use ipc_types::schema;
use ipc_types::topics::{self, Arity, Commands, Topic, TopicVisitor, WorldState, for_each_topic};
use proptest::prelude::*;
use zerocopy::{FromBytes, IntoBytes};

/// A message of a topic made of arbitrary bytes: any bytes are a valid message.
fn message<T: Topic>(bytes: &[u8], elements: usize) -> (T::Header, Vec<T::Element>) {
    let mut source = bytes.iter().copied().cycle();
    let mut take = |n: usize| -> Vec<u8> { source.by_ref().take(n).collect() };
    let header = T::Header::read_from_bytes(&take(size_of::<T::Header>())).unwrap();
    let elements = (0..if T::ARITY == Arity::One { 1 } else { elements })
        .map(|_| T::Element::read_from_bytes(&take(size_of::<T::Element>())).unwrap())
        .collect();
    (header, elements)
}

struct RoundTrip<'a>(&'a [u8], usize);

impl TopicVisitor for RoundTrip<'_> {
    type Error = TestCaseError;
    fn visit<T: Topic>(&mut self) -> Result<(), TestCaseError> {
        let (header, elements) = message::<T>(self.0, self.1);
        let mut bytes = vec![0xee];
        cdr::encode::<T>(&header, &elements, &mut bytes);
        prop_assert_eq!(bytes[0], 0xee, "what was there before stays");
        let bytes = &bytes[1..];
        prop_assert_eq!(bytes.len(), cdr::encoded_len::<T>(elements.len()));
        let (header_again, elements_again) = cdr::decode::<T>(bytes)
            .map_err(|e| TestCaseError::fail(format!("{}: {e}", T::NAME)))?;
        // Compared as bytes, because NaN does not equal itself.
        prop_assert_eq!(header.as_bytes(), header_again.as_bytes(), "{}", T::NAME);
        prop_assert_eq!(
            elements.as_bytes(),
            elements_again.as_bytes(),
            "{}",
            T::NAME
        );
        for cut in [0, 3, 4, bytes.len() / 2, bytes.len() - 1] {
            prop_assert!(
                cdr::decode::<T>(&bytes[..cut]).is_err(),
                "{} cut to {cut}",
                T::NAME
            );
        }
        let longer = [bytes, &[0]].concat();
        prop_assert!(
            cdr::decode::<T>(&longer).is_err(),
            "{} with a byte too many",
            T::NAME
        );
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn every_topic_survives_the_round_trip_byte_by_byte(
        bytes in proptest::collection::vec(any::<u8>(), 1..2000), elements in 0_usize..40,
    ) {
        for_each_topic(&mut RoundTrip(&bytes, elements))?;
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        struct Decode<'a>(&'a [u8]);
        impl TopicVisitor for Decode<'_> {
            type Error = Infallible;
            fn visit<T: Topic>(&mut self) -> Result<(), Infallible> {
                let _ = cdr::decode::<T>(self.0);
                let framed = [&[0, 1, 0, 0], self.0].concat();
                let _ = cdr::decode::<T>(&framed);
                Ok(())
            }
        }
        let Ok(()) = for_each_topic(&mut Decode(&bytes));
    }
}

#[test]
fn errors_name_the_topic_and_the_lengths() {
    let big_endian = [0, 0, 0, 0, 1, 2];
    assert!(matches!(
        cdr::decode::<Commands>(&big_endian),
        Err(DecodeError::Encapsulation { found }) if found == [0, 0, 0, 0]
    ));
    let mut bytes = Vec::new();
    let (header, elements) = message::<WorldState>(&[1], 3);
    cdr::encode::<WorldState>(&header, &elements, &mut bytes);
    bytes.pop();
    let error = cdr::decode::<WorldState>(&bytes).unwrap_err().to_string();
    for part in [
        "world/state",
        "3 element(s)",
        &format!("{} bytes", bytes.len() + 1),
    ] {
        assert!(error.contains(part), "{part} missing in: {error}");
    }
}

#[test]
fn an_empty_sequence_ends_with_its_count_as_strict_readers_expect() {
    let (header, _) = message::<WorldState>(&[1], 0);
    let mut bytes = Vec::new();
    cdr::encode::<WorldState>(&header, &[], &mut bytes);
    assert_eq!(bytes.len(), 4 + size_of_val(&header) + 4);
    let (_, mut elements) = cdr::view::<WorldState>(&bytes).unwrap();
    assert!(elements.next().is_none());
    drop(elements);
    assert!(cdr::view::<WorldState>(&bytes[..bytes.len() - 1]).is_none());
    // As written up to release 0.2.
    bytes.extend([0; 4]);
    let (_, elements) = cdr::decode::<WorldState>(&bytes).unwrap();
    assert!(elements.is_empty());
}

#[test]
fn a_false_count_does_not_allocate() {
    let (header, _) = message::<WorldState>(&[0], 0);
    let mut bytes = Vec::new();
    cdr::encode::<WorldState>(&header, &[], &mut bytes);
    let count = 4 + size_of_val(&header);
    bytes[count..count + 4].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(matches!(
        cdr::decode::<WorldState>(&bytes),
        Err(DecodeError::Length { elements, .. }) if elements == u32::MAX as usize
    ));
}

#[test]
fn schemas_define_every_type_they_use_once_and_names_are_the_topics_own() {
    struct Collect(Vec<(String, String)>);
    impl TopicVisitor for Collect {
        type Error = Infallible;
        fn visit<T: Topic>(&mut self) -> Result<(), Infallible> {
            self.0
                .push((schema::message_name(T::id()), schema::ros2msg(T::id())));
            Ok(())
        }
    }
    let mut collect = Collect(Vec::new());
    let Ok(()) = for_each_topic(&mut collect);
    let names: std::collections::BTreeSet<_> = collect.0.iter().map(|(name, _)| name).collect();
    assert_eq!(names.len(), topics::NAMES.len());
    for (name, text) in &collect.0 {
        let defined: Vec<&str> = text
            .lines()
            .filter_map(|l| l.strip_prefix("MSG: "))
            .collect();
        for line in text.lines().filter(|l| l.starts_with("protean/")) {
            let used = line.split(['[', ' ']).next().unwrap();
            let times = defined.iter().filter(|d| **d == used).count();
            assert_eq!(
                times, 1,
                "{used} is defined {times} times in {name}:\n{text}"
            );
        }
    }
    assert_eq!(
        schema::message_name(WorldState::id()),
        "protean/msg/WorldState"
    );
}
