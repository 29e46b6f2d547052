//! Covers a workplace by chaotic sub-goals.
