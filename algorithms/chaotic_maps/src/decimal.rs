//! Decimal keys in exact integers: a key must not depend on how a machine parses decimals.

use crate::error::KeyError;
use crate::modulus::P;

/// Maximum number of digits after the point of a decimal key: as many as the modulus has.
const MAX_DIGITS: usize = 19;

/// `floor(0.ddd · P)` of a decimal `0.ddd`.
///
/// # Errors
/// [`KeyError::Decimal`] for any text but `0.` and digits, [`KeyError::TooManyDigits`] for more
/// than 19 digits.
pub fn decimal_state(text: &str) -> Result<u64, KeyError> {
    let digits = text
        .strip_prefix("0.")
        .filter(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()))
        .ok_or_else(|| KeyError::Decimal {
            found: text.to_owned(),
        })?;
    if digits.len() > MAX_DIGITS {
        return Err(KeyError::TooManyDigits {
            found: text.to_owned(),
            digits: digits.len(),
        });
    }
    // At most 10¹⁹ · 2⁶³ < 2¹²⁷.
    let (numerator, denominator) = digits.bytes().fold((0_u128, 1_u128), |(n, d), byte| {
        (n * 10 + u128::from(byte - b'0'), d * 10)
    });
    Ok((numerator * u128::from(P) / denominator) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_become_exact_states() {
        assert_eq!(decimal_state("0.4"), Ok(3_689_348_814_741_910_313));
        assert_eq!(decimal_state("0.644"), Ok(5_939_851_591_734_475_604));
        assert_eq!(decimal_state("0.4000"), decimal_state("0.4"));
        assert_eq!(decimal_state("0.0"), Ok(0));
        assert_eq!(decimal_state("0.9999999999999999999"), Ok(P - 1));
    }

    #[test]
    fn text_other_than_a_decimal_below_one_is_refused() {
        for text in [
            "", "0", "0.", ".5", "1.5", "-0.5", "0.5e-1", "0,5", "0.4 ", "NaN",
        ] {
            assert!(
                matches!(decimal_state(text), Err(KeyError::Decimal { .. })),
                "{text:?}"
            );
        }
        let long = "0.12345678901234567890";
        assert_eq!(
            decimal_state(long),
            Err(KeyError::TooManyDigits {
                found: long.to_owned(),
                digits: 20
            })
        );
    }
}
