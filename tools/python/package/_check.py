# SPDX-License-Identifier: BSD-3-Clause
"""Arguments from outside. Each mistake is a ValueError of one line: WHERE: found X, expected Y."""

import operator
import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

# What `settings` may be: {"command.speed_start_mps": 1.0} or ["command.speed_start_mps=1.0"].
Settings = Mapping[str, Any] | Iterable[str] | None


def shown(value: object) -> str:
    text = repr(value).replace("\n", " ")
    return text if len(text) <= 80 else text[:77] + "..."


def integer(name: str, value: object, low: int, high: int) -> int:
    try:
        number = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise ValueError(f"{name}: found {shown(value)}, expected an integer from {low} to {high}") from None
    if isinstance(value, bool) or not low <= number <= high:
        raise ValueError(f"{name}: found {shown(value)}, expected an integer from {low} to {high}")
    return number


def number(name: str, value: object) -> float:
    if isinstance(value, (bool, str, bytes)):
        raise ValueError(f"{name}: found {shown(value)}, expected a number")
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name}: found {shown(value)}, expected a number") from None


def path(name: str, value: object) -> str:
    try:
        text = os.fspath(value)  # type: ignore[call-overload]
    except TypeError:
        raise ValueError(f"{name}: found {shown(value)}, expected a name or path") from None
    if not isinstance(text, str) or not text or "\0" in text or not text.isprintable():
        raise ValueError(f"{name}: found {shown(value)}, expected a name or path")
    return text


def _toml(key: str, value: object) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        if escaped.isprintable():
            return f'"{escaped}"'
    if isinstance(value, np.ndarray):
        return _toml(key, value.tolist())
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(key, element) for element in value) + "]"
    raise ValueError(f"settings: found {key} = {shown(value)}, expected a number, truth value, text or list")


def _flat(prefix: str, mapping: Mapping[Any, Any]) -> list[str]:
    lines = []
    for key, value in mapping.items():
        if not isinstance(key, str) or not key.isprintable():
            raise ValueError(f"settings: found the key {shown(key)}, expected text")
        if isinstance(value, Mapping):
            lines += _flat(f"{prefix}{key}.", value)
        else:
            lines.append(f"{prefix}{key}={_toml(prefix + key, value)}")
    return lines


def settings_lines(settings: Settings) -> list[str]:
    """PATH=VALUE of each setting."""
    if settings is None:
        return []
    if isinstance(settings, Mapping):
        return _flat("", settings)
    try:
        lines = None if isinstance(settings, (str, bytes)) else list(settings)
    except TypeError:
        lines = None
    if lines is None:
        raise ValueError(f"settings: found {shown(settings)}, expected a dictionary or a list of PATH=VALUE")
    for line in lines:
        if not isinstance(line, str) or not line.isprintable() or "=" not in line:
            raise ValueError(f"settings: found {shown(line)}, expected PATH=VALUE")
    return lines


def indices(name: str, values: object, count: int) -> list[int]:
    """Indices of robots; None: of all."""
    if values is None:
        return list(range(count))
    try:
        array = np.asarray(values)
    except (ValueError, TypeError):
        raise ValueError(f"{name}: found {shown(values)}, expected indices from 0 to {count - 1}") from None
    if array.ndim != 1 or (array.size and array.dtype.kind not in "iu"):
        raise ValueError(f"{name}: found {shown(values)}, expected indices from 0 to {count - 1}")
    if array.size and not (0 <= array.min() and array.max() < count):
        raise ValueError(f"{name}: found {shown(values)}, expected indices from 0 to {count - 1}")
    return [int(i) for i in array]
