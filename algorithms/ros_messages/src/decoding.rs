//! Messages from their CDR form.

use crate::RosType;

/// Maximum number of bytes after the last field: writers fill up the last word.
const MAX_PADDING: usize = 3;

/// Reason why bytes are not the CDR form of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CdrError {
    /// The encapsulation is not that of plain CDR.
    #[error("the encapsulation is {0:02x?}: expected [00, 00] or [00, 01], plain CDR")]
    Encapsulation([u8; 2]),
    /// The message is too short.
    #[error("it ends in the middle of its fields")]
    Short,
    /// A text is not UTF-8.
    #[error("a text in it is not UTF-8")]
    Text,
    /// The message is too long.
    #[error("{0} bytes are left after its last field")]
    Left(usize),
}

/// Reader of plain CDR (XCDR1) of both byte orders.
#[derive(Debug)]
pub struct CdrReader<'a> {
    body: &'a [u8],
    at: usize,
    is_little: bool,
}

impl<'a> CdrReader<'a> {
    fn left(&self) -> usize {
        self.body.len().saturating_sub(self.at)
    }

    /// Returns the next bytes.
    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u8], CdrError> {
        let rest = self.body.get(self.at..).unwrap_or_default();
        let bytes = rest.get(..count).ok_or(CdrError::Short)?;
        self.at += count;
        Ok(bytes)
    }

    /// Returns the bytes of the next number, in the order of little endian.
    pub(crate) fn number<const N: usize>(&mut self) -> Result<[u8; N], CdrError> {
        self.at = self.at.next_multiple_of(N);
        let bytes = self.take(N)?.first_chunk().ok_or(CdrError::Short)?;
        let mut bytes: [u8; N] = *bytes;
        if !self.is_little {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// Returns the number of elements of the list that follows, each of at least one byte.
    pub(crate) fn count(&mut self) -> Result<usize, CdrError> {
        let count = u32::from_le_bytes(self.number()?) as usize;
        if count > self.left() {
            return Err(CdrError::Short);
        }
        Ok(count)
    }
}

/// Reads a message from its CDR form, with the encapsulation header.
///
/// # Errors
/// [`CdrError`]: the bytes are not the form of this message.
///
/// ```
/// use ros_messages::messages::Time;
///
/// let mut bytes = Vec::new();
/// ros_messages::encode(&ros_messages::time(2_500_000_000), &mut bytes);
/// let read: Time = ros_messages::decode(&bytes)?;
/// assert_eq!((read.sec, read.nanosec), (2, 500_000_000));
/// # Ok::<(), ros_messages::CdrError>(())
/// ```
pub fn decode<M: RosType>(bytes: &[u8]) -> Result<M, CdrError> {
    let (head, body) = bytes.split_first_chunk::<4>().ok_or(CdrError::Short)?;
    let is_little = match *head {
        [0, order @ (0 | 1), ..] => order == 1,
        [first, second, ..] => return Err(CdrError::Encapsulation([first, second])),
    };
    let mut input = CdrReader {
        body,
        at: 0,
        is_little,
    };
    let message = M::read(&mut input)?;
    match input.left() {
        0..=MAX_PADDING => Ok(message),
        left => Err(CdrError::Left(left)),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::messages::{
        Header, LaserScan, OccupancyGrid, Odometry, TFMessage, TransformStamped,
    };
    use crate::{encode, pose, time};

    fn header(frame: &str, time_ns: u64) -> Header {
        Header {
            stamp: time(time_ns),
            frame_id: frame.to_owned(),
        }
    }

    /// Checks that a message is read as it was written, and no part of it.
    fn check<M: RosType + PartialEq + core::fmt::Debug>(message: &M) -> Result<(), TestCaseError> {
        let mut bytes = Vec::new();
        encode(message, &mut bytes);
        let read = decode::<M>(&bytes);
        prop_assert_eq!(read.as_ref(), Ok(message));
        for length in 0..bytes.len() {
            prop_assert!(decode::<M>(&bytes[..length]).is_err(), "{} bytes", length);
        }
        let more = [bytes.as_slice(), &[0; 4]].concat();
        prop_assert_eq!(decode::<M>(&more), Err(CdrError::Left(4)));
        Ok(())
    }

    proptest! {
        #[test]
        fn messages_are_read_as_written_and_truncated_ones_are_refused(
            frame in "[a-z/ü]{0,9}",
            time_ns in 0..1_u64 << 60,
            x: f64,
            ranges in proptest::collection::vec(-1e3_f32..1e3, 0..9),
            cells in proptest::collection::vec(any::<i8>(), 0..9),
        ) {
            let header = header(&frame, time_ns);
            let mut odometry = Odometry { header: header.clone(), ..Odometry::default() };
            odometry.pose.pose = pose(x, 2.0, 0.0, 1.0);
            odometry.pose.covariance[5][5] = 7.0;
            odometry.child_frame_id.clone_from(&frame);
            check(&odometry)?;
            check(&LaserScan { header: header.clone(), ranges, ..LaserScan::default() })?;
            check(&OccupancyGrid { header: header.clone(), data: cells, ..OccupancyGrid::default() })?;
            let transform = TransformStamped { header, child_frame_id: frame, ..TransformStamped::default() };
            check(&TFMessage { transforms: vec![transform.clone(), transform] })?;
        }

        #[test]
        fn no_bytes_break_the_reader(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let bytes = [&[0, 1, 0, 0], bytes.as_slice()].concat();
            let _ = decode::<Odometry>(&bytes);
            let _ = decode::<LaserScan>(&bytes);
            let _ = decode::<TFMessage>(&bytes);
        }
    }

    #[test]
    fn both_byte_orders_are_read_and_other_encodings_named() {
        let grid = |head: [u8; 4], number: [u8; 4]| {
            let bytes = [&head[..], &number, &number, &[0, 0, 0, 0]].concat();
            decode::<Header>(&bytes).map(|header| header.stamp.sec)
        };
        assert_eq!(grid([0, 1, 0, 0], [5, 0, 0, 0]), Ok(5));
        assert_eq!(grid([0, 0, 0, 0], [0, 0, 0, 5]), Ok(5));
        assert_eq!(
            grid([0, 7, 0, 0], [5, 0, 0, 0]).unwrap_err().to_string(),
            "the encapsulation is [00, 07]: expected [00, 00] or [00, 01], plain CDR"
        );
    }
}
