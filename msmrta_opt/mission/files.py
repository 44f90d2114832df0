"""Files: read within limits and with clear errors, and written whole or not at all.

All text that the package takes, of whatever format, comes through `read_text`: a regular file, or ``-``
for standard input, of at most `LARGEST_MIB`, in UTF-8 with or without a byte order mark. JSON and TOML
come through `read_json` and `read_toml`, which refuse what their parsers take without a word: keys
given twice, numbers that are not finite, and depths and digits that nothing after them could take.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
import stat
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from .errors import InputError, at, shown

LARGEST_MIB = 64
"""Size of the largest text that is read."""
DEEPEST = 100
"""Levels of lists and tables within each other."""
MAX_DIGITS = 300
"""Of a whole number; a longer one is beyond the range of a float."""
_TOO_LARGE = 10**MAX_DIGITS
NOT_FINITE = "{}; give a finite number"


def read_text(path: str | Path) -> str:
    r"""The text of `path`, as UTF-8, its lines ended by ``\n``.

    Parameters
    ----------
    path : path
        A regular file, or ``-`` for standard input, which is read once and then remembered.

    Raises
    ------
    InputError
        If there is no such file, it is not a regular one, too large, or cannot be read as text.
    """
    try:
        data = _standard_input() if str(path) == "-" else _bytes_of(Path(path))
        if len(data) > LARGEST_MIB * 2**20:
            raise InputError(f"too large; give at most {LARGEST_MIB} MiB", file=path)
        text = data.decode("utf-8-sig")
    except FileNotFoundError:
        raise InputError("no such file", file=path) from None
    except UnicodeDecodeError as error:
        raise InputError(f"not a UTF-8 text file ({error.reason})", file=path) from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", file=path) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _bytes_of(path: Path) -> bytes:
    """What is in `path`, up to a byte more than may be."""
    _check_regular(path, "a regular file, or - for standard input")
    with path.open("rb") as file:
        return file.read(LARGEST_MIB * 2**20 + 1)


def check_regular(path: Path) -> None:
    """Refuse what a library could not read from `path`: no file, a folder, a device, a pipe.

    Raises
    ------
    InputError
        Naming the file.
    """
    try:
        _check_regular(path, "a regular file")
    except FileNotFoundError:
        raise InputError("no such file", file=path) from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", file=path) from None


def _check_regular(path: Path, right: str) -> None:
    try:
        mode = path.stat().st_mode
    except ValueError:  # a null character, or half of a surrogate pair
        raise InputError("no file can have this name", file=repr(str(path))) from None
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "not a regular file"
        raise InputError(f"cannot be read ({kind}); give {right}", file=path)


@cache
def _standard_input() -> bytes:
    return sys.stdin.buffer.read(LARGEST_MIB * 2**20 + 1)


def read_json(path: str | Path) -> Any:
    """The JSON document in `path`; see `parse_json` and `read_text` for what is refused."""
    try:
        return parse_json(read_text(path))
    except InputError as error:
        raise error.within(path) from None


def parse_json(text: str) -> Any:
    """The JSON document in `text`.

    Raises
    ------
    InputError
        If it is broken, a key is given twice, a number is not finite or has more than `MAX_DIGITS`
        digits, or it is nested deeper than `DEEPEST`.
    """
    return _parsed(text, "JSON", lambda text: json.loads(text, object_pairs_hook=_table))


def read_toml(path: str | Path) -> dict[str, Any]:
    """The TOML document in `path`; refused is what `parse_json` and `read_text` refuse."""
    import tomllib

    try:
        document: dict[str, Any] = _parsed(read_text(path), "TOML", tomllib.loads)
    except InputError as error:
        raise error.within(path) from None
    return document


def read_yaml(path: str | Path) -> Any:
    """The YAML document in `path`; refused is what `parse_json` and `read_text` refuse, and aliases."""
    try:
        return _parsed(read_text(path), "YAML", _parse_yaml)
    except InputError as error:
        raise error.within(path) from None


def _parse_yaml(text: str) -> Any:
    import yaml

    class Loader(yaml.SafeLoader):  # type: ignore[misc]
        """Finds keys given twice, and takes no aliases, with which a short file can say too much."""

        def compose_node(self, parent: Any, index: Any) -> Any:
            if self.check_event(yaml.AliasEvent):
                mark = self.peek_event().start_mark
                raise InputError("an alias; write out what it stands for", field=_line(mark))
            return super().compose_node(parent, index)

        def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
            whole = super().construct_mapping(node, deep=True)
            keys = [self.construct_object(key, deep=True) for key, _ in node.value]
            return _table([(key, whole[key]) for key in keys])

    try:
        return yaml.load(text, Loader)
    except yaml.YAMLError as error:
        said = " ".join((getattr(error, "problem", None) or str(error)).split())
        mark = getattr(error, "problem_mark", None)
        raise InputError(
            f"broken YAML: {said}", field="" if mark is None else _line(mark)
        ) from None


def _line(mark: Any) -> str:
    return f"line {mark.line + 1}"


def _parsed(text: str, language: str, parse: Callable[[str], Any]) -> Any:
    try:
        document = parse(text)
        fault = _fault(document)
    except RecursionError:
        raise InputError(f"nested too deep; give at most {DEEPEST} levels") from None
    except InputError:
        raise
    except ValueError as error:
        if type(error) is not ValueError:  # the parser's own
            raise InputError(f"broken {language}: {error}") from None
        # Python reads no number of so many digits, and does not say where it stands.
        found = re.search(rf"[\d_]{{{MAX_DIGITS + 1},}}", text)
        line = text.count("\n", 0, found.start() if found else 0) + 1
        raise InputError(_too_many_digits(), field=f"line {line}") from None
    if fault is not None:
        place, problem = fault
        if _fault(document, finite=False) is None:
            raise NotFiniteError(document, list(_not_finite(document)))
        raise InputError(problem, field=at(*place))
    return document


def _not_finite(value: Any, place: tuple[str | int, ...] = ()) -> Iterator[InputError]:
    """What is wrong with each number that is not finite."""
    if isinstance(value, float) and not math.isfinite(value):
        yield InputError(NOT_FINITE.format(shown(value)), field=at(*place))
    if isinstance(value, (dict, list)):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _not_finite(item, (*place, key))


class NotFiniteError(InputError):
    """A document in which a number is not finite, the first of `each`; all else can be taken."""

    def __init__(self, document: Any, each: list[InputError]) -> None:
        super().__init__(each[0].problem, field=each[0].field, file=each[0].file)
        self.document, self.each = document, each

    def within(self, file: str | os.PathLike[str]) -> NotFiniteError:
        """The same errors, each said of `file`."""
        return NotFiniteError(self.document, [error.within(file) for error in self.each])


@dataclass(frozen=True)
class _Repeated:
    """Stands in a table for a key that was given twice."""


def _table(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        counted = Counter(key for key, _ in pairs)
        table |= {key: _Repeated() for key, times in counted.items() if times > 1}
    return table


Fault = tuple[tuple[str | int, ...], str]


def _fault(value: Any, depth: int = 0, *, finite: bool = True) -> Fault | None:
    """The first place in a document at which something cannot be taken, and what."""
    if isinstance(value, int):
        return None if -_TOO_LARGE < value < _TOO_LARGE else ((), _too_many_digits())
    if isinstance(value, float):
        return (
            ((), NOT_FINITE.format(shown(value))) if finite and not math.isfinite(value) else None
        )
    if isinstance(value, str):
        return None if value.isascii() or _is_unicode(value) else ((), "half a surrogate pair")
    if isinstance(value, _Repeated):
        return (), "is given twice; give it once"
    if not isinstance(value, (dict, list)):
        return None
    if depth == DEEPEST:
        raise RecursionError
    is_table = isinstance(value, dict)
    for key, item in value.items() if isinstance(value, dict) else enumerate(value):
        if not is_table and type(item) is int and -_TOO_LARGE < item < _TOO_LARGE:
            continue  # of cells there are millions
        fault = _fault(item, depth + 1, finite=finite)
        if fault is None and is_table:
            fault = _fault(key)
        if fault is not None:
            return (key, *fault[0]), fault[1]
    return None


def _is_unicode(text: str) -> bool:
    return not any("\ud800" <= character <= "\udfff" for character in text)


def _too_many_digits() -> str:
    return f"a number of more than {MAX_DIGITS} digits; give fewer"


def write_with(path: str | Path, write: Callable[[Path], None]) -> None:
    """Let `write` fill a temporary file, then move it into the place of `path`.

    Readers see the old file or the new one, never half of one; the new one has the old one's
    permissions. A link stays a link: what it points at is replaced. What is not a regular file, such
    as a device or a pipe, is written through.

    Raises
    ------
    InputError
        If the folder does not exist, or it or the file cannot be written.
    """
    path = Path(path)
    try:
        old = _status(path)
        through = old is not None and _is_written_through(old)
        target = Path(os.path.realpath(path))
        if old is not None and not os.access(path, os.W_OK):
            raise PermissionError(13, "Permission denied")
        # The suffix is kept: writers such as matplotlib choose their format by it.
        handle, name = tempfile.mkstemp(
            suffix=path.suffix,
            prefix=f".{path.stem[:40]}-",  # a name may be as long as the system allows
            dir=None if through else target.parent,
        )
    except OSError as error:
        raise InputError(f"cannot be written ({error.strerror})", file=path) from None
    os.close(handle)
    temporary = Path(name)
    try:
        write(temporary)
        if through:
            _copy_into(path, temporary.read_bytes())
        else:
            _take_permissions(temporary, old)
            temporary.replace(target)
    except BrokenPipeError:
        pass  # a reader such as `head` has what it wanted
    except OSError as error:
        raise InputError(f"cannot be written ({error.strerror or error})", file=path) from None
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: str | Path, text: str) -> None:
    """Write `text` to `path` as UTF-8, whole or not at all."""
    write_with(path, lambda temporary: _write(temporary, text))


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def _status(path: Path) -> os.stat_result | None:
    try:
        return path.stat()
    except FileNotFoundError:
        return None


def _is_written_through(old: os.stat_result) -> bool:
    return not (stat.S_ISREG(old.st_mode) or stat.S_ISDIR(old.st_mode)) or _stream(old) is not None


def _stream(old: os.stat_result) -> int | None:
    """The standard stream that is this file, such as ``/dev/stdout`` sent into a file."""
    for descriptor in (1, 2):
        with contextlib.suppress(OSError):
            if os.path.samestat(old, os.fstat(descriptor)):
                return descriptor
    return None


def _copy_into(path: Path, data: bytes) -> None:
    stream = _stream(path.stat())
    for held in (sys.stdout, sys.stderr):
        if held is not None:
            held.flush()
    # Opened anew, a file that is a standard stream would be overwritten from its beginning.
    with open(path if stream is None else os.dup(stream), "wb") as file:
        file.write(data)


def _take_permissions(temporary: Path, old: os.stat_result | None) -> None:
    if old is None:
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        return
    if hasattr(os, "chown"):
        with contextlib.suppress(OSError):  # only root may give files away
            os.chown(temporary, old.st_uid, old.st_gid)
    temporary.chmod(stat.S_IMODE(old.st_mode))
