//! Encoding of numbers for the page: small integers, differences, deflate, base64.

use std::io::{self, Write as _};

use data_encoding::BASE64;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;

/// Code for "no value" in packed positions and values.
pub const NONE: u16 = u16::MAX;
/// Largest code of a position or a value.
const MAX_VALUE: f64 = 65_534.0;
/// Smallest distance between two codes of positions (m).
const MIN_STEP: f64 = 1e-3;

/// Raster that maps positions to integers: 1 mm, or coarser in a world larger than 65 m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Raster {
    /// Position with the codes 0, 0 (m).
    pub(super) origin: [f64; 2],
    /// Distance between two neighbouring codes (m).
    pub(super) step: f64,
}

impl Raster {
    /// Returns a raster for this part of the plane with a margin.
    pub(super) fn from_bounds(min: [f64; 2], max: [f64; 2]) -> Self {
        let extent = (max[0] - min[0]).max(max[1] - min[1]).max(1.0);
        let margin = (0.05 * extent).max(1.0);
        let whole = extent + 2.0 * margin;
        Self {
            origin: [min[0] - margin, min[1] - margin],
            step: (whole / MAX_VALUE).max(MIN_STEP),
        }
    }

    /// Returns the codes of a position; outside, those of the nearest position inside.
    pub(super) fn pack(&self, p: [f64; 2]) -> [u16; 2] {
        [0, 1].map(|i| {
            let number = ((p[i] - self.origin[i]) / self.step).round();
            // The cast saturates; NaN becomes 0.
            number.clamp(0.0, MAX_VALUE) as u16
        })
    }

    /// Like [`Self::pack`], with [`NONE`] for a position outside.
    pub(super) fn pack_if_inside(&self, p: [f64; 2]) -> [u16; 2] {
        let inside = [0, 1].iter().all(|&i| {
            let number = (p[i] - self.origin[i]) / self.step;
            (-0.5..=MAX_VALUE + 0.5).contains(&number)
        });
        if inside { self.pack(p) } else { [NONE; 2] }
    }

    /// Returns the position of these codes (m).
    #[cfg(test)]
    pub(super) fn unpack(&self, n: [u16; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.origin[i] + f64::from(n[i]) * self.step)
    }
}

/// Encodes an angle (rad) in units of 1/65536 turn.
pub fn pack_angle(theta: f64) -> u16 {
    let turns = theta / core::f64::consts::TAU;
    (((turns - turns.floor()) * 65_536.0).round() as u32 & 0xffff) as u16
}

/// Values from a minimum to a maximum in 65534 steps.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Range {
    /// Value of code 0.
    pub(super) min: f64,
    /// Value of code 65534.
    pub(super) max: f64,
}

impl Range {
    /// Returns the range of the finite values.
    pub(super) fn from_values(values: impl Iterator<Item = f64>) -> Self {
        let (min, max) = values
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| {
                (a.min(v), b.max(v))
            });
        if min <= max {
            Self { min, max }
        } else {
            Self { min: 0.0, max: 0.0 }
        }
    }

    /// Returns the code of a value; [`NONE`] if it is not finite.
    pub(super) fn pack(&self, value: f64) -> u16 {
        if !value.is_finite() {
            return NONE;
        }
        let span = self.max - self.min;
        if span > 0.0 {
            ((value - self.min) / span * MAX_VALUE)
                .round()
                .clamp(0.0, MAX_VALUE) as u16
        } else {
            0
        }
    }
}

/// Encodes a time in units of 0.1 ms, rounded down, so that nothing is shown too late.
pub fn pack_time(time_ns: u64) -> u32 {
    u32::try_from(time_ns / 100_000).unwrap_or(u32::MAX)
}

/// Position and encoding of a list of numbers in the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Section {
    name: String,
    /// Offset of the first byte.
    at: usize,
    /// Count of numbers.
    length: usize,
    /// Size of a number (bytes): 1, 2 or 4.
    bytes: usize,
    /// Number of times that differences were taken.
    differences: u8,
}

/// Lists of numbers by name.
#[derive(Debug, Default)]
pub struct Lists {
    data: Vec<u8>,
    sections: Vec<Section>,
}

macro_rules! put {
    ($($put:ident: $number:ty),+) => {
        $(
            /// Adds a list; takes differences of neighbours `differences` times.
            pub(super) fn $put(&mut self, name: &str, mut numbers: Vec<$number>, differences: u8) {
                for _ in 0..differences {
                    let mut before = 0;
                    for number in &mut numbers {
                        let this = *number;
                        *number = this.wrapping_sub(before);
                        before = this;
                    }
                }
                let bytes = size_of::<$number>();
                self.begin(name, numbers.len(), bytes, differences);
                // Bytes of the same significance go together: they are similar, and compress
                // better.
                for worth in 0..bytes {
                    self.data.extend(numbers.iter().map(|n| n.to_le_bytes()[worth]));
                }
            }
        )+
    };
}

impl Lists {
    put!(u8: u8, u16: u16, u32: u32);

    fn begin(&mut self, name: &str, length: usize, bytes: usize, differences: u8) {
        self.sections.push(Section {
            name: name.to_owned(),
            at: self.data.len(),
            length,
            bytes,
            differences,
        });
    }

    /// Returns the position and encoding of every list.
    pub(super) fn contents(&self) -> serde_json::Value {
        serde_json::json!(self.sections)
    }

    /// Returns all lists, deflated (zlib) and in base64.
    pub(super) fn finish(&self, compression: Compression) -> io::Result<String> {
        let mut encoder = ZlibEncoder::new(Vec::new(), compression);
        encoder.write_all(&self.data)?;
        Ok(BASE64.encode(&encoder.finish()?))
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use flate2::read::ZlibDecoder;
    use proptest::prelude::*;

    use super::*;

    /// Decodes base64 as the page does.
    fn from_base64(text: &str) -> Vec<u8> {
        let value = |c: u8| match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            _ => 63,
        };
        let mut bytes = Vec::new();
        for four in text.as_bytes().chunks(4) {
            let digits: Vec<u8> = four.iter().take_while(|&&c| c != b'=').copied().collect();
            let bits = digits
                .iter()
                .fold(0_u32, |bits, &c| bits << 6 | u32::from(value(c)))
                << (6 * (4 - digits.len()));
            bytes.extend(&bits.to_be_bytes()[1..digits.len()]);
        }
        bytes
    }

    /// Decodes a list of 2-byte numbers as the page does.
    fn unpack(data: &[u8], section: &Section) -> Vec<u16> {
        let n = section.length;
        let bytes = &data[section.at..section.at + 2 * n];
        let mut numbers: Vec<u16> = (0..n)
            .map(|i| u16::from_le_bytes([bytes[i], bytes[n + i]]))
            .collect();
        for _ in 0..section.differences {
            let mut sum = 0_u16;
            for number in &mut numbers {
                sum = sum.wrapping_add(*number);
                *number = sum;
            }
        }
        numbers
    }

    proptest! {
        #[test]
        fn packed_numbers_are_restored(
            a in prop::collection::vec(any::<u16>(), 0..200),
            b in prop::collection::vec(any::<u16>(), 0..50),
            differences in 0_u8..3,
        ) {
            let mut lists = Lists::default();
            lists.u16("a", a.clone(), differences);
            lists.u8("between", vec![7; 3], 1);
            lists.u16("b", b.clone(), 2);
            let mut data = Vec::new();
            ZlibDecoder::new(from_base64(&lists.finish(Compression::fast()).unwrap()).as_slice())
                .read_to_end(&mut data)
                .unwrap();
            prop_assert_eq!(unpack(&data, &lists.sections[0]), a);
            prop_assert_eq!(unpack(&data, &lists.sections[2]), b);
        }

        #[test]
        fn places_are_wrong_by_half_a_step_at_most(
            size in 0.1_f64..2000.0, u in 0.0_f64..1.0, v in 0.0_f64..1.0,
        ) {
            let min = [-size / 3.0, 5.0];
            let max = [min[0] + size, min[1] + size / 2.0];
            let raster = Raster::from_bounds(min, max);
            prop_assert!(raster.step <= (size * 1.1 / 65_534.0).max(1e-3) * (1.0 + 1e-9) || size < 20.0);
            let p = [min[0] + u * size, min[1] + v * size / 2.0];
            prop_assert_ne!(raster.pack_if_inside(p), [NONE; 2]);
            let q = raster.unpack(raster.pack(p));
            for i in [0, 1] {
                prop_assert!((p[i] - q[i]).abs() <= raster.step * 0.500_001);
            }
        }

        #[test]
        fn values_are_wrong_by_half_a_step_at_most(
            values in prop::collection::vec(-1e3_f64..1e3, 1..50),
        ) {
            let range = Range::from_values(values.iter().copied());
            let step = (range.max - range.min) / 65_534.0;
            for v in values {
                let back = range.min + f64::from(range.pack(v)) * step;
                prop_assert!((v - back).abs() <= step * 0.500_001 + 1e-12);
            }
        }

        #[test]
        fn angles_are_wrong_by_half_a_part_of_a_turn(theta in -7.0_f64..7.0) {
            let turn = core::f64::consts::TAU;
            let back = f64::from(pack_angle(theta)) / 65_536.0 * turn;
            let off = (theta - back).rem_euclid(turn);
            prop_assert!(off.min(turn - off) <= turn / 65_536.0 * 0.500_001);
        }
    }

    #[test]
    fn outside_and_infinite_values_have_the_code_none_or_are_clamped() {
        let raster = Raster::from_bounds([0.0; 2], [10.0; 2]);
        assert_eq!(raster.pack_if_inside([f64::INFINITY, 1.0]), [NONE; 2]);
        assert_eq!(raster.pack_if_inside([1.0, f64::NAN]), [NONE; 2]);
        assert_eq!(raster.pack([-1e9, 1e9]), [0, 65_534]);
        let range = Range::from_values([f64::INFINITY, 3.0].into_iter());
        assert_eq!(range.pack(f64::INFINITY), NONE);
        assert_eq!(range.pack(3.0), 0);
        assert_eq!(
            Range::from_values([f64::NAN].into_iter()),
            Range { min: 0.0, max: 0.0 }
        );
    }
}
