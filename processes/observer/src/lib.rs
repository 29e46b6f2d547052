//! An adversary that watches robots and predicts where they will be.
