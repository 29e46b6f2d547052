//! Messages from their CDR form.

use byteorder::{BigEndian, LittleEndian};
use serde::de::DeserializeOwned;

/// Reason why bytes are not the CDR form of a message.
#[derive(Debug, thiserror::Error)]
pub enum CdrError {
    /// The encapsulation is not that of plain CDR.
    #[error("it does not begin with 00 00 or 00 01: expected plain CDR")]
    Encapsulation,
    /// The message is too short, or has other fields.
    #[error("it has not the fields of its type: {0}")]
    Fields(#[from] cdr_encoding::Error),
}

/// Reads a message from its CDR form (XCDR1), with the encapsulation header, in either byte order.
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
pub fn decode<M: DeserializeOwned>(bytes: &[u8]) -> Result<M, CdrError> {
    let (message, _) = match bytes.split_first_chunk() {
        Some(([0, 1, _, _], body)) => cdr_encoding::from_bytes::<M, LittleEndian>(body)?,
        Some(([0, 0, _, _], body)) => cdr_encoding::from_bytes::<M, BigEndian>(body)?,
        _ => return Err(CdrError::Encapsulation),
    };
    Ok(message)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::RosType;
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
    fn check<M: RosType + DeserializeOwned + PartialEq + core::fmt::Debug>(
        message: &M,
    ) -> Result<(), TestCaseError> {
        let mut bytes = Vec::new();
        encode(message, &mut bytes);
        let read = decode::<M>(&bytes);
        prop_assert_eq!(&read.unwrap(), message);
        for length in 0..bytes.len() {
            prop_assert!(decode::<M>(&bytes[..length]).is_err(), "{} bytes", length);
        }
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
        assert_eq!(grid([0, 1, 0, 0], [5, 0, 0, 0]).unwrap(), 5);
        assert_eq!(grid([0, 0, 0, 0], [0, 0, 0, 5]).unwrap(), 5);
        assert_eq!(
            grid([0, 7, 0, 0], [5, 0, 0, 0]).unwrap_err().to_string(),
            "it does not begin with 00 00 or 00 01: expected plain CDR"
        );
    }
}
