//! A team's knowledge of its opponents.

use crate::message::ZeroCopySend;

use crate::headers;
use crate::message;
use crate::stamp::Stamp;

message! {
    /// One opponent in `perception/sighting`.
    pub struct Sighting = "protean/Sighting" {
        x: f64 = "measured x [m]; 0 if unseen",
        y: f64 = "measured y [m]; 0 if unseen",
        theta: f64 = "measured heading [rad]; 0 unless the heading is known",
        sigma: f64 = "standard deviation of x and y each [m]; infinite if unseen",
        visibility: f64 = "largest line-of-sight visibility over the observers, 0..1",
        robot: u32 = "index of the observed robot",
        observer: u32 = "index of the observer with the best view, or 4294967295",
        seen: u8 = "1 if there is a measurement",
        heading_known: u8 = "1 if the sensor model measures headings",
        reserved: [u8; 6] = "always 0",
    }
}

message! {
    /// Header of `perception/belief`.
    pub struct BeliefHeader = "protean/BeliefHeader" {
        stamp: Stamp = "when, in which order, by whom",
        mean_x: f64 = "mean of the particles, x [m]",
        mean_y: f64 = "mean of the particles, y [m]",
        mean_theta: f64 = "circular mean of the headings [rad]",
        covariance_xx: f64 = "variance of x [m^2]",
        covariance_xy: f64 = "covariance of x and y [m^2]",
        covariance_yy: f64 = "variance of y [m^2]",
        heading_spread: f64 = "1 - length of the mean heading vector, 0 (certain) .. 1 (unknown)",
        effective_sample_size: f64 = "1 / sum of squared weights before resampling",
        robot: u32 = "index of the robot that the belief is about",
        seen: u32 = "1 if it was seen at this tick",
    }
}

message! {
    /// One hypothesis in `perception/belief`.
    pub struct Particle = "protean/Particle" {
        x: f32 = "x [m]",
        y: f32 = "y [m]",
        theta: f32 = "heading [rad]",
        weight: f32 = "share of the belief; all weights of a message sum to 1",
    }
}

headers!(BeliefHeader);
