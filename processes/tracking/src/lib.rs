//! Line-of-sight sightings and beliefs about robots that others watch: visibility, particle filters.
