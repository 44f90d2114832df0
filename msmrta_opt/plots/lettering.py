"""Names as they are written, whatever they hold: dollars, letters of any script, any length."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache, wraps
from itertools import takewhile
from typing import Any, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

from matplotlib.artist import Artist
from matplotlib.axis import Axis
from matplotlib.font_manager import FontProperties, findfont, fontManager, get_font
from matplotlib.text import Text
from matplotlib.textpath import text_to_path
from numpy.typing import ArrayLike

Asked = ParamSpec("Asked")
Drawn = TypeVar("Drawn", bound=Artist)

LONGEST_NAME, LONGEST_LINE = 40, 200
"""Characters of a name beside others, and of a line: more would push the rest off the page."""
HINTED = 1.05
"""By how much a line may be wider on a screen's pixels than its letters are by themselves."""
LAST_RESORT = "Last Resort"
BOX = "\N{WHITE SQUARE}"
"""Stands for a character that no font here has."""


def as_written(draw: Callable[Asked, Drawn]) -> Callable[Asked, Drawn]:
    """Make a function that draws show every text of its own as it is written.

    Matplotlib takes what stands between two dollar signs for mathematics, and warns of each
    character that its font lacks.
    """

    @wraps(draw)
    def drawing(*arguments: Asked.args, **options: Asked.kwargs) -> Drawn:
        given = [x for x in (*arguments, *options.values()) if isinstance(x, Artist)]
        before = {text: text.get_text() for artist in given for text in _texts(artist)}
        drawn = draw(*arguments, **options)
        for text in _texts(drawn):
            if text.get_text() not in ("", before.get(text), _plain.get(text)):
                _set_plainly(text)
        return drawn

    return drawing


def write_plainly(drawn: Artist) -> None:
    """Show every text of a finished picture as it is written, once."""
    for text in _texts(drawn):
        if text.get_text() not in ("", _plain.get(text)):
            _set_plainly(text)


def shortened(text: str, longest: int = LONGEST_NAME) -> str:
    """`text`, each of its lines cut to so many characters."""
    lines = text.split("\n")
    return "\n".join(x if len(x) <= longest else f"{x[: longest - 1]}…" for x in lines)


def told_apart(names: Iterable[str], longest: int = LONGEST_NAME) -> dict[str, str]:
    """By name what a picture says of it: those that are cut stay as different as they were.

    Of names that would look alike, what they have in common is left out, not what they differ by.
    """
    whole = list(dict.fromkeys(names))
    head = longest // 4
    found = {name: shortened(name, longest) for name in whole}
    for alike in _alike(found):
        rests = {name: name[head:] for name in alike}
        cut = _differing(list(rests.values()), longest - head)
        found |= {name: name[:head] + cut[rest] for name, rest in rests.items()}
    for alike in _alike(found):  # where what differs is itself too long to be shown
        found |= {name: f"{found[name][: longest - 4]}… {i}" for i, name in enumerate(alike, 1)}
    return found


def _differing(texts: list[str], longest: int) -> dict[str, str]:
    """Each cut to so many characters from the word on by which it differs."""
    same = takewhile(lambda letters: len(set(letters)) == 1, zip(*texts, strict=False))
    common = len(list(same))
    word = texts[0].rfind(" ", max(common - 12, 0), common) + 1
    start = word or max(common - 4, 0)
    found = {text: shortened(f"…{text[start:]}" if start else text, longest) for text in texts}
    for alike in _alike(found):
        if len(alike) < len(texts):
            found |= _differing(alike, longest)
    return found


def _alike(found: dict[str, str]) -> list[list[str]]:
    """The keys that share a value, together."""
    groups: dict[str, list[str]] = {}
    for key, value in found.items():
        groups.setdefault(value, []).append(key)
    return [group for group in groups.values() if len(group) > 1]


def fitted(text: str, size: float, width: float, *, bold: bool = False) -> str:
    """`text` in one line, cut so that letters of `size` points take no more than `width` points."""
    line = " ".join(text.split())[:LONGEST_LINE]
    width /= HINTED
    if width_of(line, size, bold=bold) <= width:
        return line
    low, high = 0, len(line)
    while low < high:
        middle = (low + high + 1) // 2
        if width_of(f"{line[:middle]}…", size, bold=bold) <= width:
            low = middle
        else:
            high = middle - 1
    return f"{line[:low].rstrip()}…"


def as_many_as_fit(parts: Sequence[str], size: float, width: float, end: str = "") -> str:
    """The first of `parts` in one line, no more than fit whole, and `end` after them.

    The first is cut where it does not fit alone.
    """
    lines = [f"{' · '.join(parts[:n])}{end}" for n in range(len(parts), 0, -1)]
    return next((x for x in lines if fitted(x, size, width) == x), fitted(lines[-1], size, width))


@cache
def width_of(text: str, size: float, *, bold: bool = False) -> float:
    """Points that a line of letters of `size` points takes."""
    font = FontProperties(size=size, weight="bold" if bold else "normal")
    more, said = _fonts_for(text.replace("\n", " "), font)
    font.set_family([*font.get_family(), *more])
    width: float = text_to_path.get_text_width_height_descent(said, font, ismath=False)[0]
    return width


_plain: WeakKeyDictionary[Text, str] = WeakKeyDictionary()
"""Texts that are set plainly already, by a picture that is a part of another."""


def _texts(artist: Artist) -> list[Text]:
    """The texts of an artist, without the labels of ticks: those take theirs anew when drawn.

    To ask for the ticks would make them all, which takes longer than to draw the rest.
    """
    if isinstance(artist, Text):
        return [artist]
    if isinstance(artist, Axis):
        return [artist.label, artist.offsetText]
    return [text for child in artist.get_children() for text in _texts(child)]


def name_ticks(
    axis: Axis, places: ArrayLike | range, names: Iterable[object], **style: Any
) -> None:
    """Put `names` at `places` along `axis`, as they are written.

    Ticks take their texts anew, as they were given, whenever they are drawn.
    """
    found = [_fonts_for(shortened(str(name)), FontProperties()) for name in names]
    more = dict.fromkeys(family for families, _ in found for family in families)
    if more:
        style["fontfamily"] = [*FontProperties().get_family(), *more]
    axis.set_ticks(places, [_escaped(said) for _, said in found], **style)


def _escaped(text: str) -> str:
    return text.replace("$", r"\$")


def _set_plainly(text: Text) -> None:
    font = text.get_fontproperties()
    fonts, said = _fonts_for(shortened(text.get_text(), LONGEST_LINE), font)
    if fonts:
        text.set_fontfamily([*text.get_fontfamily(), *fonts])
    # Not `set_parse_math`, which would stay with the title of axes whatever is written there later.
    text.set_text(_escaped(said))
    _plain[text] = text.get_text()


def _fonts_for(text: str, font: FontProperties) -> tuple[Sequence[str], str]:
    """The families that have what `font` lacks, and the text with boxes for what none has."""
    if text.isascii() and text.replace("\n", "").isprintable():
        return (), text
    own = findfont(font)
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
    """Upright fonts, by family and file, in an order that is always the same.

    Without matplotlib's own that has a box for every character: before others it would hide theirs.
    """
    return sorted(
        {
            (font.name, font.fname)
            for font in fontManager.ttflist
            if font.style == "normal" and not font.name.startswith(LAST_RESORT)
        }
    )
