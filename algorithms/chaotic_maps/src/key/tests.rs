use super::*;
use crate::error::KINDS;
use crate::source::Source as _;
use expect_test::expect;
use proptest::prelude::*;

const K: &str = "chebp:123456789012345678,987654321098765432";

#[test]
fn keys_read_as_they_are_written_in_the_documentation() {
    let key = |text: &str| text.parse::<Key>().unwrap();
    assert_eq!(
        key("catp:0.4,0.644"),
        Key::CatP {
            a: 3_689_348_814_741_910_313,
            b: 5_939_851_591_734_475_604
        }
    );
    assert_eq!(key("catp:5,0.4"), key(" catp : 5 , 3689348814741910313 "));
    assert_eq!(
        key("cat64:12345,67890"),
        Key::Cat64 {
            a: 12_345,
            b: 67_890
        }
    );
    assert_eq!(
        key(K),
        Key::ChebP {
            tx: 123_456_789_012_345_678,
            ty: 987_654_321_098_765_432,
            emission: Emission::Arcsine
        }
    );
    assert_eq!(
        key("chebf64-raw:0.1,-0.2").kind(),
        KeyKind::ChebF64(Emission::Raw)
    );
    assert_eq!(key("standard:0.1,0.2"), key("standard:0.1,0.2,7"));
    let secret = "00ff".repeat(16);
    assert_eq!(
        key(&format!("keyed:{secret}")).to_string(),
        format!("keyed:{secret}")
    );
}

#[test]
fn serde_uses_the_same_text() {
    let key: Key = serde_json::from_str(&format!("{K:?}")).unwrap();
    assert_eq!(serde_json::to_string(&key).unwrap(), format!("{K:?}"));
    let kind: KeyKind = serde_json::from_str("\"logistic-raw\"").unwrap();
    assert_eq!(kind, KeyKind::Logistic(Emission::Raw));
    let error = serde_json::from_str::<Key>("\"cat:1,2\"")
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("`cat` is not a generator") && error.contains("catp"),
        "{error}"
    );
}

#[test]
fn every_kind_is_named_in_messages_and_gives_sound_keys() {
    for kind in KeyKind::ALL {
        assert!(KINDS.split(", ").any(|name| name == kind.to_string()));
        assert_eq!(kind.to_string().parse(), Ok(kind));
        for seed in [0, 1, u64::MAX] {
            let key = Key::from_seed(kind, seed);
            assert_eq!(key.kind(), kind);
            assert_eq!(key, Key::from_seed(kind, seed));
            assert_ne!(key, Key::from_seed(kind, 5));
            let mut source = key.source().unwrap();
            for _ in 0..1000 {
                assert!(source.next_unit().iter().all(|c| (0.0..=1.0).contains(c)));
                assert!(
                    source
                        .next_symmetric()
                        .iter()
                        .all(|c| (-1.0..=1.0).contains(c))
                );
            }
        }
    }
    assert_eq!(KINDS.split(", ").count(), KeyKind::ALL.len());
}

#[test]
fn both_views_of_a_point_take_one_step() {
    for kind in KeyKind::ALL {
        let mut unit = Key::from_seed(kind, 3).source().unwrap();
        let mut symmetric = unit.clone();
        let mut ahead = unit.clone();
        ahead.advance(5);
        for _ in 0..5 {
            let (u, s) = (unit.next_unit(), symmetric.next_symmetric());
            assert!((0..2).all(|axis| (2.0 * u[axis] - 1.0 - s[axis]).abs() < 1e-15));
        }
        assert_eq!(unit.next_unit(), ahead.next_unit(), "{kind}");
    }
}

#[test]
fn text_that_is_no_key_is_refused_with_what_to_change() {
    let texts = [
        "",
        "catp",
        "lorenz:1,2",
        "catp:1",
        "catp:1,2,3",
        "catp:1.5,2",
        "catp:-1,2",
        "catp:0.12345678901234567890,2",
        "cat64:0.4,1",
        "chebp:0.4,0.5",
        "catf64:a,0.5",
        "standard:1,2,3,4",
        "keyed:abc",
        &format!("keyed:{}", "g".repeat(64)),
        &format!("keyed:{}", "é".repeat(64)),
    ];
    let errors = texts.map(|text| text.parse::<Key>().unwrap_err().to_string());
    expect![[r#"
        `` is not a generator: expected `kind:values` with one of the kinds catp, cat64, catf64, chebp, chebp-raw, chebf64, chebf64-raw, logistic, logistic-raw, standard, keyed
        `catp` is not a generator: expected `kind:values` with one of the kinds catp, cat64, catf64, chebp, chebp-raw, chebf64, chebf64-raw, logistic, logistic-raw, standard, keyed
        `lorenz` is not a generator: expected `kind:values` with one of the kinds catp, cat64, catf64, chebp, chebp-raw, chebf64, chebf64-raw, logistic, logistic-raw, standard, keyed
        the key `1` of `catp` has 1: expected two values, separated by commas
        the key `1,2,3` of `catp` has 3: expected two values, separated by commas
        `1.5` is not a decimal key: expected `0.` and digits, such as 0.644, or a whole number
        `-1` is no state of `catp`: expected a whole number from 0 to 2^64 - 1
        `0.12345678901234567890` has 20 digits after the point: expected at most 19
        `0.4` is no state of `cat64`: expected a whole number from 0 to 2^64 - 1
        `0.4` is no state of `chebp`: expected a whole number from 0 to 2^64 - 1
        `a` is no value of `catf64`: expected a number such as 0.644
        the key `1,2,3,4` of `standard` has 4: expected two or three values, separated by commas
        the key of `keyed` has 3 characters: expected 64 hexadecimal digits (32 bytes)
        the key of `keyed` has 64 characters, some of which are not hexadecimal digits: expected 64 hexadecimal digits (32 bytes)
        the key of `keyed` has 64 characters, some of which are not hexadecimal digits: expected 64 hexadecimal digits (32 bytes)"#]].assert_eq(&errors.join("\n"));
}

#[test]
fn degenerate_keys_are_read_but_give_no_source() {
    let texts = [
        "catp:0,0",
        "catp:0.0,0.0",
        "cat64:2,4",
        "catf64:0.5,0.25",
        "catf64:0.3125,0.6875",
        "catf64:NaN,0.4",
        "catf64:0.4,1",
        "chebp:5,9223372036854775778",
        "chebp-raw:0,1",
        "chebf64:0.1,-0.1",
        "chebf64:0.5,0.2",
        "chebf64:0.1,1.2",
        "logistic:0.2,0.8",
        "standard:0,0",
    ];
    let errors = texts.map(|text| {
        let key: Key = text.parse().unwrap();
        key.validate().unwrap_err().to_string()
    });
    expect![[r#"
        the key of `catp` is all zero, a fixed point: make at least one value other than 0
        the key of `catp` is all zero, a fixed point: make at least one value other than 0
        both values of `cat64` are even (2, 4), which shortens the period: make one of them odd
        the key (0.5, 0.25) of `catf64` repeats after 3 steps, because its values are multiples of a large power of 1/2: choose values with more digits, such as 0.4 and 0.644
        the key (0.3125, 0.6875) of `catf64` repeats after 12 steps, because its values are multiples of a large power of 1/2: choose values with more digits, such as 0.4 and 0.644
        `x` of `catf64` is NaN: expected at least 0 and below 1
        `y` of `catf64` is 1: expected at least 0 and below 1
        the values 5 and 9223372036854775778 of `chebp` are equal or mirrored, so that all points lie on a diagonal: change one of them
        `tx` of `chebp-raw` is 0: expected above 0 and below 2^63 - 25 = 9223372036854775783
        the values 0.1 and -0.1 of `chebf64` are equal or mirrored, so that all points lie on a diagonal: change one of them
        `x` of `chebf64` is 0.5, which leads to a fixed point (0, 1/2, sqrt(3)/2 and 1, of either sign): choose a value away from these
        `y` of `chebf64` is 1.2: expected between -1 and 1
        the values 0.2 and 0.8 of `logistic` are equal or mirrored, so that all points lie on a diagonal: change one of them
        `x` of `standard` is 0, which leads to a fixed point (0 and 1/2 where y is 0): choose a value away from these"#]].assert_eq(&errors.join("\n"));
}

/// Any key, valid or not.
fn any_key() -> impl Strategy<Value = Key> {
    let number = prop_oneof![
        -2.0..2.0_f64,
        any::<f64>().prop_filter("NaN", |x| !x.is_nan())
    ];
    (
        0..KeyKind::ALL.len(),
        any::<[u64; 2]>(),
        [number.clone(), number.clone(), number],
        any::<[u8; 32]>(),
    )
        .prop_map(|(kind, [a, b], [x, y, k], key)| match KeyKind::ALL[kind] {
            KeyKind::CatP => Key::CatP { a, b },
            KeyKind::Cat64 => Key::Cat64 { a, b },
            KeyKind::CatF64 => Key::CatF64 { x, y },
            KeyKind::ChebP(emission) => Key::ChebP {
                tx: a,
                ty: b,
                emission,
            },
            KeyKind::ChebF64(emission) => Key::ChebF64 { x, y, emission },
            KeyKind::Logistic(emission) => Key::Logistic { x, y, emission },
            KeyKind::Standard => Key::Standard { x, y, k },
            KeyKind::Keyed => Key::Keyed { key },
        })
}

#[test]
fn the_robots_of_a_team_have_different_valid_keys_of_its_kind() {
    for kind in KeyKind::ALL {
        let team = Key::from_seed(kind, 7);
        let keys: Vec<Key> = (0..20).map(|robot| team.of_robot(robot)).collect();
        assert_eq!(keys[0], team);
        for (robot, key) in keys.iter().enumerate() {
            assert_eq!(key.kind(), kind);
            key.validate().unwrap();
            assert!(!keys[..robot].contains(key), "{key}");
            assert_ne!(*key, Key::from_seed(kind, 8).of_robot(robot as u64));
        }
    }
}

proptest! {
    #[test]
    fn text_reads_back_as_the_same_key(key in any_key()) {
        prop_assert_eq!(key.to_string().parse::<Key>(), Ok(key));
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in "\\PC{0,80}", kind in 0..KeyKind::ALL.len()) {
        let _ = text.parse::<Key>();
        let key = format!("{}:{text}", KeyKind::ALL[kind]).parse::<Key>();
        if let Ok(key) = key {
            let _ = key.validate();
        }
    }
}
