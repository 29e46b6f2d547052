//! Coverage of a workplace with obstacles: its division into rectangles, tours, legs, and planners of sub-goals.
