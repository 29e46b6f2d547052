"""Pages of documentation: Markdown templates with slots for numbers and tables, and the figures beside them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from .._optional import imported
from . import figures, files

#: The first line of every page.
MARK = "<!-- Written by `protean reproduce` from results; edits belong into its templates. -->\n\n"
#: The rule for several tests on one page.
MULTIPLICITY = "p-values are corrected by Holm's method over the tests of a table, a list or a claim; decisions are at 5 %."
#: The text in place of a part without results.
NO_RESULTS = "*No results of this experiment.*"


@dataclass(frozen=True)
class Page:
    """A page, as Markdown, and its figures, in the folder `images` beside it."""

    text: str
    images: list[figures.Chart] = field(default_factory=list)

    @cached_property
    def drawings(self) -> dict[str, bytes]:
        """The figures as SVG, by name."""
        return {image.name: figures.svg(image) for image in self.images}

    def write(self, path: Path) -> list[Path]:
        """Writes the page and its figures; returns the files."""
        written = {path.with_name("images") / f"{name}.svg": svg for name, svg in self.drawings.items()}
        written[path] = self.text.encode()
        for file, data in written.items():
            files.save(file, data)
        return list(written)


def environment(*, autoescape: bool = False) -> Any:
    """The templates; a slot without a value is an error."""
    jinja2 = imported("jinja2")
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).with_name("templates")),
        undefined=jinja2.StrictUndefined,
        autoescape=autoescape,
        trim_blocks=True,
        keep_trailing_newline=True,
    )


def fill(template: str, values: Mapping[str, Any]) -> str:
    """Fills a template: slots with tables and lines, without the line break at their end."""

    def trimmed(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {name: trimmed(inner) for name, inner in value.items()}
        return value.rstrip() if isinstance(value, str) else value

    texts = {"no_results": NO_RESULTS, "multiplicity": MULTIPLICITY}
    text: str = environment().get_template(template).render(trimmed(values), **texts)
    return MARK + text
