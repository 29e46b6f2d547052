"""Optional packages."""

import importlib
from types import ModuleType

#: Extras of the package by the module that they bring.
_EXTRAS = {"jinja2": "lab", "matplotlib": "plot", "PIL": "plot", "pyarrow": "arrow", "scipy": "lab"}


def imported(name: str) -> ModuleType:
    """Imports a module of an optional package; the error says how to install it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        package = name.partition(".")[0]
        extra = _EXTRAS.get(package)
        wanted = f"'protean-robotics[{extra}]'" if extra else package
        raise ImportError(f"{package} is missing: pip install {wanted}", name=package) from error
