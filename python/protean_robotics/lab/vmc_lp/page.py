"""The page ``docs/results/vmc-lp.md``."""

from typing import Any

from .. import words
from ..page import Page, fill
from . import sensitivity, versus
from .evidence import EXPERIMENTS, Evidence


def build(evidence: Evidence) -> Page:
    """Builds the page."""
    values: dict[str, Any] = dict.fromkeys(EXPERIMENTS)
    images, provenance = [], ""
    for name, part in zip(EXPERIMENTS, (sensitivity, versus), strict=True):
        study = evidence.studies.get(name)
        if study is not None:
            values |= part.values(study) | {name: True}
            images.append(part.chart(study))
            provenance += words.provenance(name, study.seeds, study.program)
    return Page(fill("vmc-lp.md", values | {"provenance": provenance}), images)
