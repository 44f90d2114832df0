"""Files as they come out of accidents: bytes, tokens, lines and fields changed, lost or doubled."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from typing import Any

ODD_BYTES = [
    b"\0",
    b"\xff",
    b"\xef\xbb\xbf",
    b"\r",
    b"\r\n",
    b"\x1b[2J",
    "ψ".encode(),
    b"\xed\xa0\x80",
]
ODD_VALUES: list[Any] = [
    *(None, True, False, 0, 1, -1, 2, 0.5, -0.0, 1e-9, 1e9, 1e-308, 1e308, 5e-324, 10**9, 10**17),
    *(2**53, 2**63, 2**64, 10**30, 10**299, -(10**30), float("nan"), float("inf"), float("-inf")),
    *("", "-", "0", "NaN", "x" * 1000, "\0", "\ud800", "\u202e", "../../etc/passwd", "/dev/zero"),
    *([], [[]], [0], [0, 0], [0] * 50, {}, {"": 0}, {"rows": []}, {"rows": ["."]}),
]
ODD_TEXTS = [
    *("1e999", "-1e999", "1e-999", "nan", "inf", "-inf", "1,5", "1.5.2", "0x1", "1_0", "٣", "--1"),
    *("1e20", "1e30", "-1e20", "1e15", "1e-12", "9" * 400, "9" * 5000, "[" * 3000, "{" * 3000, "-"),
    *("<", "<=", ">", "=", ":", "::", "+", "*", "/", "^", "\\", "$", "[", "]", "'", '"', ",", ";"),
    *("free", "end", "st", "bounds", "bin", "semi", "sos", "max", "min", "inf", "subject", "to"),
    *("ROWS", "COLUMNS", "RHS", "RANGES", "BOUNDS", "ENDATA", "NAME", "OBJSENSE", "QUADOBJ", "SOS"),
    *("N", "L", "G", "E", "UP", "LO", "FX", "FR", "MI", "PL", "BV", "LI", "UI", "SC", "'MARKER'"),
    *("map", "MAP ", "height", "width", "type octile", ".", "@", "#", "x", "x y", "0", "1", "-1"),
]


def mutated(original: bytes, draw: random.Random) -> bytes:
    """`original` after one to three accidents."""
    data = original
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        kinds = [_bytes, _lines, _tokens]
        if original[:1] == b"{":
            kinds += [_fields, _fields, _fields]
        data = draw.choice(kinds)(data, draw)
    return data


def _piece(size: int, draw: random.Random, longest: int = 40) -> slice:
    start = draw.randrange(size + 1)
    return slice(start, min(start + draw.randint(1, longest), size))


def _bytes(data: bytes, draw: random.Random) -> bytes:
    piece, other = _piece(len(data), draw), _piece(len(data), draw)
    new = draw.choice(
        [
            b"",
            data[piece] * 2,
            data[piece][::-1],
            data[other],
            draw.choice(ODD_BYTES),
            draw.choice(ODD_TEXTS).encode(),
            draw.randbytes(draw.randint(1, 4)),
        ]
    )
    if draw.random() < 0.1:
        return data[: piece.start]
    return data[: piece.start] + new + data[piece.stop :]


def _lines(data: bytes, draw: random.Random) -> bytes:
    lines = data.split(b"\n")
    i, j = (draw.randrange(len(lines)) for _ in range(2))
    change = draw.randrange(5)
    if change == 0:
        del lines[i]
    elif change == 1:
        lines.insert(j, lines[i])
    elif change == 2:
        lines[i], lines[j] = lines[j], lines[i]
    elif change == 3:
        lines.insert(i, draw.choice(ODD_TEXTS).encode())
    else:
        lines[i] = draw.choice(
            [lines[i].upper(), lines[i].strip(), b" " + lines[i], lines[i] + b" "]
        )
    return b"\n".join(lines)


def _tokens(data: bytes, draw: random.Random) -> bytes:
    lines = data.split(b"\n")
    i = draw.randrange(len(lines))
    words = lines[i].split(b" ")
    k = draw.randrange(len(words))
    new = draw.choice([b"", draw.choice(ODD_TEXTS).encode(), words[k] + b" " + words[k]])
    words[k] = draw.choice([new, words[draw.randrange(len(words))]])
    lines[i] = b" ".join(words)
    return b"\n".join(lines)


def _fields(data: bytes, draw: random.Random) -> bytes:
    try:
        document = json.loads(data)
    except (ValueError, RecursionError):
        return _bytes(data, draw)
    places = list(_places(document))
    if not places:
        return _bytes(data, draw)
    holder, key = draw.choice(places)
    other, there = draw.choice(places)
    change = draw.randrange(8)
    if change == 0:
        del holder[key]
    elif change == 1:
        holder[key] = other[there]
        # Nothing holds itself.
        document = json.loads(data) if _is_endless(document) else document
    elif change == 2 and isinstance(holder, dict):
        holder[draw.choice(["", "id", "extra", key + " ", key.upper()])] = holder.pop(key)
    elif change == 3 and isinstance(holder, list):
        holder.insert(key, holder[key])
    elif change == 4 and isinstance(holder[key], (int, float)):
        holder[key] = draw.choice([-1, 0.5, 2, 1e6, 1e-6, 1e12]) * holder[key]
    else:
        holder[key] = draw.choice(ODD_VALUES)
    return json.dumps(document, indent=draw.choice([None, 1])).encode()


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every place of a document: what holds it, and its key."""
    keys: Any = value if isinstance(value, dict) else range(len(value))
    for key in keys:
        yield value, key
        if isinstance(value[key], (dict, list)):
            yield from _places(value[key])


def _is_endless(document: Any) -> bool:
    try:
        json.dumps(document)
    except ValueError:
        return True
    return False
