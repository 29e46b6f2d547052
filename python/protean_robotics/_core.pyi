"""The compiled part of the package."""

__version__: str

class Error(Exception):
    """Failure of Protean."""

class InvalidInput(Error):
    """Scenario, file or argument that is invalid."""

class Map:
    """A map with its clearances and exact pieces."""

    @property
    def revision(self) -> int:
        """Number that changes with every obstacle."""
