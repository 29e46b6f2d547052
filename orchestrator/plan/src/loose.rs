//! JSON of unknown form, stored with limits on its size.

use core::fmt;

use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use trajectory_problem::problem::MAX_OBSTACLES;

/// Maximum number of stored elements of a list: one more than the permitted maximum.
const KEPT: usize = MAX_OBSTACLES + 1;
/// Maximum length of a text in messages (characters).
const SHOWN: usize = 60;

/// The stored elements of a list. Numbers and points, which are most of a large file, take 8 and 16 bytes.
#[derive(Debug, Clone, PartialEq)]
pub enum Items {
    /// Numbers only.
    Numbers(Vec<f64>),
    /// Pairs of numbers only.
    Points(Vec<[f64; 2]>),
    /// Any values.
    Any(Vec<Loose>),
}

impl Items {
    /// Returns the number of stored elements.
    fn len(&self) -> usize {
        match self {
            Self::Numbers(list) => list.len(),
            Self::Points(list) => list.len(),
            Self::Any(list) => list.len(),
        }
    }

    /// Returns an element.
    pub fn get(&self, index: usize) -> Option<Loose> {
        match self {
            Self::Numbers(list) => list.get(index).map(|v| Loose::Number(*v)),
            Self::Points(list) => {
                let pair = |point: &[f64; 2]| Loose::List(Self::Numbers(point.to_vec()), 2);
                list.get(index).map(pair)
            }
            Self::Any(list) => list.get(index).cloned(),
        }
    }

    /// Returns the elements in order.
    pub fn iter(&self) -> impl Iterator<Item = Loose> + '_ {
        (0..self.len()).filter_map(|index| self.get(index))
    }

    /// Appends an element.
    fn push(&mut self, value: Loose) {
        if self.len() == 0 {
            *self = match &value {
                Loose::Number(_) => Self::Numbers(Vec::new()),
                Loose::List(Self::Numbers(_), 2) => Self::Points(Vec::new()),
                _ => Self::Any(Vec::new()),
            };
        }
        match (&mut *self, value) {
            (Self::Numbers(list), Loose::Number(v)) => list.push(v),
            (Self::Points(list), Loose::List(Self::Numbers(pair), 2)) => {
                list.extend(<[f64; 2]>::try_from(pair));
            }
            (Self::Any(list), value) => list.push(value),
            (_, value) => {
                let mut list: Vec<Loose> = self.iter().collect();
                list.push(value);
                *self = Self::Any(list);
            }
        }
    }
}

/// A JSON value.
#[derive(Debug, Clone, PartialEq)]
pub enum Loose {
    /// `null`.
    Null,
    /// True or false.
    Bool(bool),
    /// A number; whole numbers beyond 2⁵³ are rounded.
    Number(f64),
    /// Text.
    Text(String),
    /// A list: its first elements and its length.
    List(Items, usize),
    /// An object with its entries in order.
    Object(Vec<(String, Loose)>),
}

impl Loose {
    /// Returns an entry of an object; `None` if it is absent or `null`, or if this is not an object.
    pub fn get(&self, key: &str) -> Option<&Self> {
        let Self::Object(entries) = self else {
            return None;
        };
        let found = entries.iter().find(|(name, _)| name == key);
        found.map(|(_, value)| value).filter(|v| **v != Self::Null)
    }
}

/// Shows the value, shortened.
impl fmt::Display for Loose {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("null"),
            Self::Bool(v) => write!(f, "{v}"),
            Self::Number(v) => write!(f, "{v}"),
            Self::Text(text) => {
                let short: String = text.chars().take(SHOWN).collect();
                let dots = if short.len() < text.len() { "…" } else { "" };
                write!(f, "{short:?}{dots}")
            }
            Self::List(_, count) => write!(f, "a list of {count}"),
            Self::Object(entries) => {
                let names: Vec<&str> = entries.iter().map(|(name, _)| name.as_str()).collect();
                let names: String = names.join(", ").chars().take(SHOWN).collect();
                write!(f, "an object with {names:?}")
            }
        }
    }
}

impl<'de> Deserialize<'de> for Loose {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LooseVisitor)
    }
}

struct LooseVisitor;

impl<'de> Visitor<'de> for LooseVisitor {
    type Value = Loose;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_unit<E: Error>(self) -> Result<Loose, E> {
        Ok(Loose::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Loose, E> {
        Ok(Loose::Bool(value))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Loose, E> {
        Ok(Loose::Number(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Loose, E> {
        Ok(Loose::Number(value as f64))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Loose, E> {
        Ok(Loose::Number(value as f64))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Loose, E> {
        Ok(Loose::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Loose, A::Error> {
        let mut kept = Items::Any(Vec::new());
        while kept.len() < KEPT
            && let Some(element) = list.next_element::<Loose>()?
        {
            kept.push(element);
        }
        let mut count = kept.len();
        while kept.len() == KEPT && list.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        Ok(Loose::List(kept, count))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Loose, A::Error> {
        let mut entries: Vec<(String, Loose)> = Vec::new();
        while let Some(key) = map.next_key::<String>()? {
            // No valid instance has so many keys.
            if entries.len() >= 64 {
                map.next_value::<IgnoredAny>()?;
                continue;
            }
            if entries.iter().any(|(name, _)| *name == key) {
                return Err(A::Error::custom(format_args!("`{key}` occurs twice")));
            }
            // Instances may contain results of other programs, perhaps large.
            if key == "results" || key == "samples" {
                map.next_value::<IgnoredAny>()?;
                continue;
            }
            entries.push((key, map.next_value()?));
        }
        Ok(Loose::Object(entries))
    }
}
