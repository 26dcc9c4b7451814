"""Campaign texts gone wrong: bytes, lines, words and structure of the shipped campaigns changed at random, and values for ``--set``."""

import json
import random
from functools import cache
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

CAMPAIGNS = Path(__file__).resolve().parents[2] / "campaigns"

WORDS = """
~ true false -1 0 1 1e400 -1e308 5e-324 .nan .inf -.inf [] {} [1,2,3] {kind:x} '30_m' *a &a <<: !!set !!binary !!python/object:os.system
99999999999999999999 - ? | > % @ ` --- ... ,,, a.b obstacles obstacles.O obstacles.Q.radius_m sweep begin kind name none jsbsim kinematic
point_mass scoam orca planes gtm_t2 c172p t37 nowhere 0x1F 1_000 12:30:45 2026-01-01 "\\uD800" "\\x1b[31m" ../../etc/passwd /dev/zero nul
""".split()
"""Short texts that have meant something to some reader of YAML, or to ours."""

ODD = ["", " ", "\t", "\0", "\r", "\x85", "\u2028", "\ufeff", "\u202e", "\U0001f6e9", "é", "\x7f", ": ", "#", "\n  ", "\n- ", '"', "'"]

HUGE = [0, -0.0, 1, -1, 0.5, 1e-9, 1e-300, 5e-324, 1e3, 1e6, 1e9, 1e15, 1e300, -1e300, 10**30, float("inf"), float("nan")]
OTHER = [
    None,
    True,
    "",
    "30 m",
    "x" * 300,
    [],
    {},
    [0, 0, 0],
    [1e300, 0, 0],
    [[1, 2], 3],
    {"kind": "none"},
    {"kind": "nowhere"},
    {"O": {"name": "P"}},
]


def files() -> list[Path]:
    return sorted(CAMPAIGNS.rglob("*.yaml"))


@cache
def text(file: Path) -> bytes:
    return file.read_bytes()


@cache
def data(file: Path) -> str:
    """A campaign's plain data, as JSON."""
    return json.dumps(YAML(typ="safe", pure=True).load(text(file)))


def a_file(rng: random.Random) -> Path:
    """One of the shipped campaigns; a small one, which is read fast, more often."""
    every = files()
    return rng.choices(every, [len(text(file)) ** -1.5 for file in every])[0]


def mutated(rng: random.Random) -> bytes:
    """A campaign after a few changes of one sort."""
    file = a_file(rng)
    sort = rng.choices([_bytes, _lines, _words, _structure, _bomb], [3, 3, 4, 6, 0.3])[0]
    return sort(rng, file)


def _bytes(rng: random.Random, file: Path) -> bytes:
    out = bytearray(text(file))
    for _ in range(rng.randint(1, 6)):
        at, length = rng.randrange(len(out) + 1), rng.randint(1, 40)
        how = rng.randrange(5)
        if how == 0:
            del out[at : at + length]
        elif how == 1:
            out[at:at] = rng.randbytes(rng.randint(1, 4))
        elif how == 2:
            out[at:at] = rng.choice(ODD).encode()
        elif how == 3:
            out[at:at] = out[at : at + length]
        elif rng.random() < 0.2:
            del out[at:]
    return bytes(out)


def _lines(rng: random.Random, file: Path) -> bytes:
    lines = text(file).decode().splitlines(keepends=True)
    for _ in range(rng.randint(1, 4)):
        at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
        how = rng.randrange(5)
        if how == 0 and len(lines) > 1:
            del lines[at]
        elif how == 1:
            lines.insert(at, lines[other])
        elif how == 2:
            lines[at], lines[other] = lines[other], lines[at]
        elif how == 3:
            lines[at] = " " * rng.randint(1, 6) + lines[at]
        else:
            lines[at] = lines[at].lstrip()
    return "".join(lines).encode()


def _words(rng: random.Random, file: Path) -> bytes:
    words = text(file).decode().split(" ")
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(words))
        if rng.random() < 0.7:
            words[at] = rng.choice(WORDS + ODD)
        else:
            words.insert(at, words[rng.randrange(len(words))])
    return " ".join(words).encode()


def _structure(rng: random.Random, file: Path) -> bytes:
    """Changes of the data itself, so that the text can be read and only what it says is wrong."""
    root = json.loads(data(file))
    for _ in range(rng.randint(1, 5)):
        holder, key = _place(rng, root)
        how = rng.randrange(7)
        if how == 0:
            del holder[key]
        elif how == 1:
            holder[key] = rng.choice(HUGE)
        elif how == 2:
            holder[key] = rng.choice(OTHER)
        elif how == 3:
            other, there = _place(rng, root)
            holder[key] = json.loads(json.dumps(other[there]))
        elif how == 4 and isinstance(holder, dict):
            holder[_misspelt(rng, str(key))] = holder.pop(key)
        elif how == 5 and isinstance(holder, list):
            holder.extend([holder[key]] * rng.choice([1, 3, 2000]))
        else:
            holder[key] = {str(key): holder[key]} if rng.random() < 0.5 else [holder[key]]
        if not root:
            break
    return (
        json.dumps(root, indent=1, ensure_ascii=False).replace("Infinity", ".inf").replace("NaN", ".nan").encode("utf-8", "surrogatepass")
    )


def _place(rng: random.Random, root: Any) -> tuple[Any, Any]:
    """A container in the data and a key of it, at any depth."""
    node = root
    while True:
        key = rng.choice(list(node)) if isinstance(node, dict) else rng.randrange(len(node))
        inner = node[key]
        if not (isinstance(inner, dict | list) and inner) or rng.random() < 0.3:
            return node, key
        node = inner


def _misspelt(rng: random.Random, name: str) -> str:
    at = rng.randrange(len(name) + 1)
    return rng.choice([name[:at] + name[at + 1 :], name[:at] + rng.choice("aez_. ") + name[at:], name.upper(), name[::-1], ""])


def _bomb(rng: random.Random, file: Path) -> bytes:
    """Small on disk and large when read: aliases that multiply, depth, many keys, long numbers and texts."""
    size = rng.choice([10, 30, 100, 1000, 5000])
    bombs = [
        "\n".join(["a0: &a0 [x]", *(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, min(size, 30)))]),
        "x: " + "[" * size + "]" * size,
        "x: " + "{a: " * size + "1" + "}" * size,
        "\n".join("  " * n + "a:" for n in range(min(size, 500))),
        "\n".join(f"key{n}: {n}" for n in range(size * 4)),
        f"seed: {'9' * size}\nname: {'n' * size * 40}",
        "sweep:\n  seed: [" + ", ".join(map(str, range(size * 4))) + "]",
        "sweep:\n" + "\n".join(f"  axis{n}: {{a: {{}}, b: {{}}, c: {{}}}}" for n in range(size)),
        "obstacles:\n" + "- {name: O, radius_m: -1, position_enu_m: [0, 0, x], speed_mps: 1, direction_deg: [0, 0]}\n" * size,
        "<<: &a {<<: &b {<<: *a}}",
        "? " * size + "a",
        "- " * size + "a",
        "&a [" + "*a, " * size + "]",
    ]
    bomb = rng.choice(bombs)
    whole = text(file).decode()
    return (bomb if rng.random() < 0.3 else f"{whole}\n{bomb}\n" if rng.random() < 0.5 else f"{bomb}\n{whole}").encode()


def override(rng: random.Random) -> str:
    """One ``--set``: mostly a path that is there, mostly a value that is wrong."""
    names = _paths(json.loads(data(a_file(rng))))
    path = rng.choice(names)
    if rng.random() < 0.15:
        path = rng.choice(
            [_misspelt(rng, path), f"{path}.x", path.partition(".")[2], "", "=", "obstacles", f"sweep.{path}", f"draw.{path}"]
        )
    value = rng.choice([*WORDS, *map(str, HUGE), *(json.dumps(one) for one in OTHER), *ODD])
    return f"{path}={value}"


def _paths(node: Any, before: str = "") -> list[str]:
    items = node.items() if isinstance(node, dict) else [(item.get("name", "O"), item) for item in node if isinstance(item, dict)]
    out = []
    for key, inner in items:
        path = f"{before}.{key}" if before else str(key)
        out += [path, *(_paths(inner, path) if isinstance(inner, dict | list) else [])]
    return out
