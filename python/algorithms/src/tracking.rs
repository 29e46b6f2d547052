//! Beliefs about observed robots.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use ::tracking::params::{FilterParams, SensorParams};
use ::tracking::particle_filter::{self, MotionLimits};
use ::tracking::sighting::{Measurement, Sighting};
use ::tracking::space::Space;
use ::tracking::watch::Watch;
use geometry::pose::Pose2;
use nalgebra::Point2;
use numpy::{PyArray1, PyArray2};
use planner_view::map::PlannerMap;
use pyo3::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use scenario::spec::MAX_ROBOTS;

use crate::arguments::{self, scalar};
use crate::error::Error;
use crate::interruptible::{compute, each};
use crate::map::Map;

/// Particle filter of the pose of one robot.
///
/// Each particle is a pose with a hypothesis of speed and turning rate. An update moves, weighs and resamples the
/// particles; where none is left, the belief is rebuilt. (Chasing-game paper, section III.D.)
///
/// Parameters
/// ----------
/// map
///     The map.
/// start
///     Known pose at the start: x (m), y (m), heading (rad), shape (3,), or a robot; anywhere in free space if absent.
/// v_max
///     Maximum forward speed of the observed robot (m/s).
/// omega_max
///     Its maximum turning rate (rad/s).
/// v_reverse_max
///     Its maximum backward speed (m/s), as a magnitude.
/// seed
///     Seed of the random numbers; the same seed and calls give the same belief.
/// params
///     Other values than the defaults of ``particles`` and the further parameters of ``filter`` of a perception process.
///
/// Raises
/// ------
/// InvalidInput
///     An argument is out of range.
///
/// Examples
/// --------
/// >>> import numpy as np, protean_robotics as pr
/// >>> map = pr.Map.from_grid(np.zeros((40, 40), dtype=bool), 0.1)
/// >>> belief = pr.tracking.ParticleFilter(map, v_max=0.5, omega_max=2.0, seed=1)
/// >>> belief.particles.shape
/// (400, 4)
/// >>> belief.update(0.05, (1.0, 2.0), sigma=0.1)
/// >>> bool(np.linalg.norm(belief.mean[:2] - (1.0, 2.0)) < 0.1)
/// True
#[pyclass(frozen, module = "protean_robotics.tracking")]
#[derive(Debug)]
pub struct ParticleFilter {
    space: Arc<Space>,
    filter: Mutex<particle_filter::ParticleFilter>,
    /// Held by the thread that updates it.
    updating: Mutex<()>,
}

#[pymethods]
impl ParticleFilter {
    #[new]
    #[pyo3(signature = (map, start=None, *, v_max, omega_max, v_reverse_max=0.0, seed=0, params=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords")]
    fn new(
        py: Python<'_>,
        map: &Map,
        start: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = scalar)] v_max: f64,
        #[pyo3(from_py_with = scalar)] omega_max: f64,
        #[pyo3(from_py_with = scalar)] v_reverse_max: f64,
        #[pyo3(from_py_with = scalar)] seed: u64,
        params: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let params: FilterParams = arguments::params(params)?;
        for (name, value) in [
            ("v_max", v_max),
            ("omega_max", omega_max),
            ("v_reverse_max", v_reverse_max),
        ] {
            arguments::not_negative(name, value)?;
        }
        let limits = MotionLimits {
            v_max,
            v_reverse_max,
            omega_max,
        };
        let start = start.map(|start| arguments::pose("start", start));
        let start = start.transpose()?;
        let map = Arc::clone(&map.map);
        let (space, filter) = compute(py, move || {
            let space = space(&map);
            let rng = ChaCha8Rng::seed_from_u64(seed);
            let filter = particle_filter::ParticleFilter::new(&params, limits, start, &space, rng);
            (space, filter)
        })?;
        Ok(Self {
            space,
            filter: Mutex::new(filter),
            updating: Mutex::new(()),
        })
    }

    /// Advance the belief and apply what was seen.
    ///
    /// Parameters
    /// ----------
    /// dt
    ///     Time since the last update (s).
    /// position
    ///     Measured position (m), shape (2,); None if the robot was not seen.
    /// sigma
    ///     Standard deviation of x and of y (m); 0 for an exact measurement.
    /// heading
    ///     Measured heading (rad), if the sensor measures it.
    /// heading_sigma
    ///     Its standard deviation (rad).
    /// observers
    ///     Poses of the observers, shape (k, 3): without a position, particles that they would see lose weight.
    /// sensor
    ///     Limits of the observers' sensors: ``range`` (m), ``field_of_view`` (rad).
    ///
    /// Raises
    /// ------
    /// InvalidInput
    ///     An argument is out of range.
    #[pyo3(signature = (dt, position=None, *, sigma=0.0, heading=None, heading_sigma=0.0, observers=None, sensor=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords")]
    fn update(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = scalar)] dt: f64,
        position: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = scalar)] sigma: f64,
        #[pyo3(from_py_with = scalar)] heading: Option<f64>,
        #[pyo3(from_py_with = scalar)] heading_sigma: f64,
        observers: Option<&Bound<'_, PyAny>>,
        sensor: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        arguments::positive("dt", dt)?;
        arguments::not_negative("sigma", sigma)?;
        arguments::not_negative("heading_sigma", heading_sigma)?;
        heading.map_or(Ok(()), |heading| arguments::finite("heading", heading))?;
        let position = position.map(|position| arguments::point("position", position));
        let measurement = position.transpose()?.map(|position| Measurement {
            position,
            sigma,
            heading: heading.map(|heading| (heading, heading_sigma)),
        });
        let sighting = Sighting {
            visibility: if measurement.is_some() { 1.0 } else { 0.0 },
            observer: measurement.map(|_| 0),
            measurement,
        };
        let watch = watch(&self.space, observers, sensor)?;
        let Ok(_own) = self.updating.try_lock() else {
            return Err(Error::new_err("the filter is in use by another thread"));
        };
        let (space, mut filter) = (Arc::clone(&self.space), self.lock().clone());
        // Without an effect until it is complete.
        let updated = compute(py, move || {
            filter.update(&space, &watch, &sighting, dt);
            filter
        })?;
        *self.lock() = updated;
        Ok(())
    }

    /// Particles: x (m), y (m), heading (rad), weight; float32 of shape (particles, 4); the weights sum to 1.
    #[getter]
    fn particles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let filter = self.lock();
        arguments::array_of_rows(
            py,
            filter.particles().map(|p| [p.x, p.y, p.theta, p.weight]),
        )
    }

    /// Mean pose: x (m), y (m), circular mean of the headings (rad), shape (3,).
    #[getter]
    fn mean<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let Pose2 { x, y, theta } = self.lock().belief().mean;
        PyArray1::from_vec(py, vec![x, y, theta])
    }

    /// Covariance of the position (m²), shape (2, 2).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let belief = self.lock().belief();
        let (xx, xy, yy) = (
            belief.covariance_xx,
            belief.covariance_xy,
            belief.covariance_yy,
        );
        arguments::array_of_rows(py, [[xx, xy], [xy, yy]].into_iter())
    }

    /// Spread of the headings: 0 if all agree, 1 if the heading is unknown.
    #[getter]
    fn heading_spread(&self) -> f64 {
        self.lock().belief().heading_spread
    }

    /// Effective number of particles before the last resampling.
    #[getter]
    fn effective_sample_size(&self) -> f64 {
        self.lock().belief().effective_sample_size
    }

    /// Time since the robot was last seen (s); infinity if it never was.
    #[getter]
    fn unseen_for(&self) -> f64 {
        self.lock().belief().unseen_for
    }

    /// Number of times that the belief was rebuilt because no particle was possible.
    #[getter]
    fn rebuilt(&self) -> u64 {
        self.lock().rebuilt()
    }

    fn __len__(&self) -> usize {
        self.lock().len()
    }
}

impl ParticleFilter {
    fn lock(&self) -> MutexGuard<'_, particle_filter::ParticleFilter> {
        self.filter.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Visibility of points from observers: the product of the openness along the best line of sight.
///
/// (Chasing-game paper, section III.C.)
///
/// Parameters
/// ----------
/// map
///     The map.
/// observers
///     Poses of the observers: x (m), y (m), heading (rad), shape (k, 3).
/// points
///     Points (m), shape (2,) or (n, 2), or a robot.
/// sensor
///     Limits of the sensors: ``range`` (m), ``field_of_view`` (rad).
///
/// Returns
/// -------
/// float or ndarray
///     Visibility of each point, 0 (hidden) to 1 (in the open).
///
/// Raises
/// ------
/// InvalidInput
///     A number that is not finite, a shape that does not fit, or a limit that is out of range.
///
/// Examples
/// --------
/// >>> import numpy as np, protean_robotics as pr
/// >>> blocked = np.zeros((40, 40), dtype=bool)
/// >>> blocked[10:, 20] = True
/// >>> map = pr.Map.from_grid(blocked, 0.1)
/// >>> pr.tracking.visibility(map, [(0.5, 3.0, 0.0)], (3.5, 3.0))
/// 0.0
#[pyfunction]
#[pyo3(signature = (map, observers, points, *, sensor=None))]
pub fn visibility<'py>(
    py: Python<'py>,
    map: &Map,
    observers: &Bound<'py, PyAny>,
    points: &Bound<'py, PyAny>,
    sensor: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let points = arguments::points("points", points)?;
    let map = Arc::clone(&map.map);
    let space = compute(py, move || space(&map))?;
    let watch = watch(&space, Some(observers), sensor)?;
    let best = |&p: &Point2<f64>| watch.best(space.field(), p).map_or(0.0, |(v, _)| v);
    let values = each(py, &points.points, best)?;
    arguments::per_point(py, points.is_single, values)
}

/// Observers at these poses.
fn watch(
    space: &Space,
    observers: Option<&Bound<'_, PyAny>>,
    sensor: Option<&Bound<'_, PyAny>>,
) -> PyResult<Watch> {
    let sensor: SensorParams = arguments::params(sensor)?;
    let mut watch = Watch::new(&sensor);
    if let Some(observers) = observers {
        let expected = "finite numbers of shape (k, 3): x (m), y (m), heading (rad)";
        let rows = arguments::rows("observers", observers, expected)?;
        arguments::at_most("observers", rows.len(), MAX_ROBOTS)?;
        let poses: Vec<Pose2> = rows
            .into_iter()
            .map(|[x, y, theta]| Pose2::new(x, y, theta))
            .collect();
        watch.set(space.field(), &poses);
    }
    Ok(watch)
}

/// The map as the filter needs it.
fn space(map: &PlannerMap) -> Arc<Space> {
    map.derived().get("particles", || Space::new(map.blurred()))
}
