"""Exceptions of the package."""


class Error(Exception):
    """Failure of Protean."""

    __module__ = "protean_robotics"


class InvalidInput(Error, ValueError):
    """Scenario, file or argument that is invalid; the text names the field, the value and what is expected."""

    __module__ = "protean_robotics"
