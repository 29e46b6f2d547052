//! Arithmetic modulo the prime of the exact generators.

/// The prime 2⁶³ − 25.
///
/// One prime serves both maps: every non-zero state of the cat map has the period `P + 1`, and 6 is
/// a primitive root, so that the Chebyshev map visits every state but zero.
pub const P: u64 = (1 << 63) - 25;

/// `a + b` modulo [`P`], for `a, b < P`.
#[inline]
pub const fn add(a: u64, b: u64) -> u64 {
    // Below 2⁶⁴, as both are below 2⁶³; one conditional subtraction replaces the division.
    let sum = a + b;
    let less = sum.wrapping_sub(P);
    if sum >= P { less } else { sum }
}

/// `a − b` modulo [`P`], for `a, b < P`.
#[inline]
pub const fn sub(a: u64, b: u64) -> u64 {
    let difference = a.wrapping_sub(b);
    if a >= b {
        difference
    } else {
        difference.wrapping_add(P)
    }
}

/// `a · b` modulo [`P`].
#[inline]
pub const fn mul(a: u64, b: u64) -> u64 {
    ((a as u128 * b as u128) % P as u128) as u64
}

/// `base` to the power of `exponent` modulo [`P`].
pub const fn pow(base: u64, exponent: u64) -> u64 {
    let (mut result, mut square, mut rest) = (1, base % P, exponent);
    while rest > 0 {
        if rest & 1 == 1 {
            result = mul(result, square);
        }
        square = mul(square, square);
        rest >>= 1;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_modulus_is_the_prime_of_the_specification() {
        assert_eq!(P, 9_223_372_036_854_775_783);
        // Fermat, for the bases that decide primality below 2⁶⁴ with the strong test.
        for base in [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37] {
            let mut power = pow(base, (P - 1) >> (P - 1).trailing_zeros());
            let mut strong = power == 1 || power == P - 1;
            for _ in 1..(P - 1).trailing_zeros() {
                power = mul(power, power);
                strong |= power == P - 1;
            }
            assert!(strong, "base {base}");
        }
    }

    #[test]
    fn sums_and_differences_wrap_at_the_modulus() {
        assert_eq!(add(P - 1, 1), 0);
        assert_eq!(add(P - 1, P - 1), P - 2);
        assert_eq!(sub(0, 1), P - 1);
        assert_eq!(sub(5, 3), 2);
        assert_eq!(mul(P - 1, P - 1), 1);
    }
}
