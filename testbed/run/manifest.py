"""``manifest.json``: what a run is of and where its results come from; and whether it can be continued."""

import hashlib
import json
from typing import Any

from testbed.campaign.words.settings import Campaign
from testbed.core.registry import PACKAGE
from testbed.run import identity
from testbed.run.directory import MANIFEST, STUDY_FILES, BadInputError, RunDirectory
from testbed.run.planned import Planned, opened
from testbed.run.world import World

IDENTITY_KEYS = ("plan", "code", "versions", "plugins", "packages", "aircraft")

GUESTS = {"plugins": "plug-in", "packages": "package", "aircraft": "aircraft"}
"""What a campaign brings with it, to the word for it in messages."""

Manifest = dict[str, Any]
Fingerprint = dict[str, Any]

TOLD_OF_ORIGIN = ("campaign", "source", "overrides", "seed", "revision", "dirty", "platform", "aircraft")
"""What the page may say of a run's origin: nothing that changes with the hour, the number of workers or the folder."""


QUESTION = "campaign_hash"
"""Key of the manifest: by it a run that goes on is known before its campaign is expanded."""

FILES = "files"
"""Key of the manifest: data file to where it was and its SHA-256. A run from before there were any has none."""

MIXED = "changed while flying"
"""In the place of the code's hash: workers that started later may have read other code. Such a run cannot be continued."""


def question_hash(campaign: Campaign) -> str:
    """Of all that a campaign says, in the order in which it says it: that of its axes and values is that of its flights."""
    return identity.short(hashlib.sha256(json.dumps(campaign.model_dump(mode="json")).encode()))


def fingerprint(planned: Planned, world: World) -> Fingerprint:
    """What must be the same for a run to be continued."""
    return {
        "plan": planned.hash,
        "code": identity.code_hash(),
        "versions": identity.versions(),
        "plugins": {plugin.name: plugin.sha256 for plugin in world.plugins},
        "packages": {name.removesuffix(PACKAGE): version for name, version in planned.plugins.items() if name.endswith(PACKAGE)},
        "aircraft": identity.guests(planned.aircraft),
    }


def new(campaign: Campaign, source: str, overrides: tuple[str, ...], planned: Planned, world: World) -> Manifest:
    """The manifest of a run that begins."""
    return {
        "campaign": campaign.name,
        "source": source,
        "overrides": list(overrides),
        "seed": campaign.seed,
        "flights": len(planned),
        QUESTION: question_hash(campaign),
        "identity": fingerprint(planned, world),
        "aircraft_path": list(world.aircraft_path),
        FILES: {file.name: [file.path, file.sha256] for file in world.files},
        **identity.revision(),
        "platform": identity.machine(),
        "aircraft": identity.aircraft_hashes(planned.aircraft),
        STUDY_FILES: [],
        "history": [],
    }


def load(directory: RunDirectory) -> Manifest:
    """The manifest of a run that is there."""
    manifest = directory.load(MANIFEST)
    try:
        manifest.setdefault(FILES, {})
        _ = [manifest[key] for key in (*TOLD_OF_ORIGIN, "history")] + [manifest["identity"][key] for key in IDENTITY_KEYS]
        if not _is_sound(manifest):
            raise TypeError
    except (TypeError, KeyError, AttributeError):
        raise BadInputError(f"{directory / MANIFEST}: damaged; start again with --fresh, or into another directory with --out") from None
    return manifest


def _is_sound(manifest: Manifest) -> bool:
    """Whether what the run goes by has the types that it writes; what is only told on the page may be anything."""
    names = manifest["identity"]
    texts = [item for key in GUESTS for pair in names[key].items() for item in pair] + [*names["versions"], names["plan"], names["code"]]
    texts += [*manifest["aircraft_path"], *manifest[STUDY_FILES]]
    texts += [text for name, told in manifest[FILES].items() for text in (name, *told)]
    legs = manifest["history"]
    lists = (manifest["aircraft_path"], manifest[STUDY_FILES], manifest["overrides"], legs)
    tables = (names["versions"], manifest["platform"], manifest["aircraft"], *manifest["aircraft"].values())
    return (
        all(isinstance(one, list) for one in lists)
        and all(isinstance(one, dict) for one in tables)
        and all(isinstance(leg, dict) for leg in legs)
        and all(isinstance(text, str) and "\0" not in text for text in texts)
        and all(name.isidentifier() for name in names["plugins"])
        and all(isinstance(told, list) and len(told) == 2 for told in manifest[FILES].values())
    )


def save(directory: RunDirectory, manifest: Manifest) -> None:
    """Write it, whole."""
    directory.put(MANIFEST, json.dumps(manifest, indent=2).encode() + b"\n")


def own(directory: RunDirectory, manifest: Manifest, names: list[str]) -> None:
    """Note which files the study writes, before it does: a run removes nothing that it has not written."""
    every = sorted({*manifest[STUDY_FILES], *names})
    if every != manifest[STUDY_FILES]:
        manifest[STUDY_FILES] = every
        save(directory, manifest)


def is_same(manifest: Manifest, planned: Planned, world: World) -> bool:
    """Whether a run is of the same plan, code and versions."""
    there, now = (_flown(names, planned) for names in (manifest["identity"], fingerprint(planned, world)))
    return there == now


def refuse_another(directory: RunDirectory, manifest: Manifest, planned: Planned, world: World) -> None:
    """Raise unless the run in the directory is of the same plan, code and versions; say what differs."""
    there, now = (_flown(names, planned) for names in (manifest["identity"], fingerprint(planned, world)))
    if there == now:
        return
    why = []
    guests = [line for key, word in GUESTS.items() for line in _changed(word, there[key], now[key])]
    guests += _changed(
        "data file", {name: told[1] for name, told in manifest[FILES].items()}, {one.name: one.sha256 for one in world.files}
    )
    if there["plan"] != now["plan"]:
        details = identity.differences(campaign_there(directory), planned.campaign)
        if not details and not guests:  # a plug-in that changed makes other flights of the same campaign
            details = ["the same campaign expands to other flights"]
        why += [f"campaign: {line}" for line in details[:10]]
    if there["code"] != now["code"]:
        why.append(f"code: {there['code']} there, {now['code']} now (the sources of testbed or vosc, or aircraft, changed)")
    why += guests
    why += [f"version: {line}" for line in identity.differences(there["versions"], now["versions"])]
    raise BadInputError(
        f"{directory.path}: holds another run, which cannot be continued:\n"
        + "".join(f"  {line}\n" for line in why)
        + "start again with --fresh (removes that run), or write elsewhere with --out"
    )


def campaign_there(directory: RunDirectory) -> Any:
    """The campaign of the run in a directory, as far as its plan can tell."""
    try:
        return opened(directory / "plan.json").campaign
    except (BadInputError, OSError):
        return None


def _flown(names: Fingerprint, planned: Planned) -> Fingerprint:
    """Without the plug-ins that no flight is made of: a study that judges may change, and then judges the same flights anew."""
    return names | {"plugins": {name: sha256 for name, sha256 in names["plugins"].items() if name in planned.plugins}}


def _changed(word: str, there: dict[str, str], now: dict[str, str]) -> list[str]:
    """What of one kind the campaign brings otherwise than the run did: versions, or hashes by their beginnings."""
    return [
        f"{word} {name}: {there.get(name, 'nothing')[:12]} there, {now.get(name, 'nothing')[:12]} now"
        for name in dict.fromkeys([*there, *now])
        if there.get(name) != now.get(name)
    ]


def provenance(manifest: Manifest, planned: int, flown: int) -> dict[str, Any]:
    """What the page is told of the run's origin; of a plug-in the first digits of its SHA-256, of a package with parts its version."""
    names = manifest["identity"]
    return {key: manifest[key] for key in TOLD_OF_ORIGIN} | {
        "plan_hash": names["plan"],
        "code_hash": names["code"],
        "versions": names["versions"],
        "plug-in": {name: f"SHA-256 {sha256[:12]}" for name, sha256 in names["plugins"].items()},
        "package with parts": names["packages"],
        "flights_planned": planned,
        "flights_flown": flown,
    }
