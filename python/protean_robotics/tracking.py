"""Beliefs about observed robots."""

from . import _core

ParticleFilter = _core.tracking.ParticleFilter
visibility = _core.tracking.visibility

__all__ = ["ParticleFilter", "visibility"]
