"""Names as they are written, whatever they hold: dollars, letters of any script, any length."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache, wraps
from typing import ParamSpec, TypeVar

from matplotlib.artist import Artist
from matplotlib.font_manager import findfont, fontManager, get_font
from matplotlib.text import Text

Asked = ParamSpec("Asked")
Drawn = TypeVar("Drawn", bound=Artist)

LONGEST, LONGEST_TITLE = 100, 200
"""Characters of a line; what is longer would push everything else off the page."""
BOX = "\N{WHITE SQUARE}"
"""Stands for a character that no font here has."""


def as_written(draw: Callable[Asked, Drawn]) -> Callable[Asked, Drawn]:
    """Make a function that draws leave every text in its picture as it is written.

    Matplotlib takes what stands between two dollar signs for mathematics, and warns of each
    character that its font lacks.
    """

    @wraps(draw)
    def drawing(*arguments: Asked.args, **options: Asked.kwargs) -> Drawn:
        drawn = draw(*arguments, **options)
        for text in drawn.findobj(Text):
            if isinstance(text, Text) and text.get_text():
                _set_plainly(text)
        return drawn

    return drawing


def shortened(text: str, longest: int = LONGEST) -> str:
    """`text`, each of its lines cut to so many characters."""
    lines = text.split("\n")
    return "\n".join(x if len(x) <= longest else f"{x[: longest - 1]}…" for x in lines)


def _set_plainly(text: Text) -> None:
    said = text.get_text()
    is_title = float(text.get_fontsize()) >= 10
    plain = shortened(said, LONGEST_TITLE if is_title else LONGEST)
    if "$" in said:
        text.set_parse_math(False)
    if not plain.isascii() or not plain.replace("\n", "").isprintable():
        own = findfont(text.get_fontproperties())
        fonts, plain = _fonts_for(plain, own)
        if fonts:
            text.set_fontfamily([*text.get_fontfamily(), *fonts])
    if plain != said:
        text.set_text(plain)


def _fonts_for(text: str, own: str) -> tuple[Sequence[str], str]:
    """The families that have what the font file `own` lacks, and the text with boxes for the rest."""
    missing = {letter for letter in text if ord(letter) not in _letters(own)} - {"\n"}
    families: dict[str, None] = {}
    for entry in _fonts() if any(letter.isprintable() for letter in missing) else ():
        if found := {letter for letter in missing if ord(letter) in _letters(entry[1])}:
            families[entry[0]] = None
            missing -= found
        if not missing:
            break
    return list(families), "".join(BOX if letter in missing else letter for letter in text)


@cache
def _letters(file: str) -> frozenset[int]:
    try:
        return frozenset(get_font(file).get_charmap())
    except (OSError, RuntimeError):  # a font that cannot be used has none
        return frozenset()


def _fonts() -> Iterable[tuple[str, str]]:
    """Upright fonts, by family and file, in an order that is always the same."""
    return sorted(
        {(font.name, font.fname) for font in fontManager.ttflist if font.style == "normal"}
    )
