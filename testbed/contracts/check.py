"""``testbed check FAMILY KIND``: find the part, and try what it promises."""

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from testbed.campaign.reading.document import faults_of
from testbed.campaign.reading.nodes import parse
from testbed.campaign.reading.problems import Source, SpecError
from testbed.campaign.words.planning import MethodSpec, PlannerSpec
from testbed.campaign.words.pluggable import Pluggable
from testbed.campaign.words.settings import GuidanceSpec
from testbed.contracts import flown, guidance, method
from testbed.contracts.promise import Promise, report
from testbed.core import options, plugins, registry
from testbed.core.utf8 import whole

Contract = Callable[[str, Any, Mapping[str, Any]], list[Promise]]

CONTRACTS: dict[str, Contract] = {"method": method.promises, "guidance": guidance.promises, "planner": flown.promises_of_planner}
"""Family to its contract; a method that is a class is a law over time."""

SECTIONS: dict[str, type[Pluggable]] = {"method": MethodSpec, "guidance": GuidanceSpec, "planner": PlannerSpec}
"""Family to the section of a campaign that names such a part."""


class CheckError(Exception):
    """There is nothing to check; str() says why."""


def check(family: str, kind: str, given: Mapping[str, Any]) -> tuple[bool, Iterator[str]]:
    """(Are all promises kept?, lines to print.) ``kind`` may be the path of a file: ``study/tangent.py:avoid``. Raises ``CheckError``."""
    file, colon, attribute = kind.rpartition(":")
    if colon:
        path = Path(file if file.endswith(".py") else f"{file}.py")
        kind = f"{path.stem}:{attribute}"
    try:
        if colon:
            plugins.add([plugins.read(path)])
        part = registry.part(family, kind)
    except (plugins.PluginError, registry.UnknownPartError) as error:
        raise CheckError(str(error)) from None
    described = _described(family, kind, part, given)
    every = [described, *([] if described.broken else _contract(family, part)(kind, part, given))]
    return all(promise.kept for promise in every), report(f"{family} '{kind}'", every)


def _contract(family: str, part: Any) -> Contract:
    return flown.promises_of_law if family == "method" and inspect.isclass(part) else CONTRACTS[family]


def given_options(written: Sequence[str]) -> dict[str, Any]:
    """``KEY=VALUE`` each, the value as a YAML would say it. Raises ``CheckError``."""
    found = {}
    for text in written:
        key, equals, value = text.partition("=")
        if not equals or not key:
            raise CheckError(f"--set {text}: expected KEY=VALUE, for example side=left")
        try:
            tree, problems = parse(Source(f"--set {text}", value, is_file=False))
        except SpecError as error:
            raise CheckError(str(error)) from None
        if problems:
            raise CheckError(str(SpecError(problems)))
        if whole(key) != key:
            raise CheckError(f"--set {whole(text)}: half a character (a lone surrogate) in the option's name")
        found[key.strip()] = tree.value
    return found


def _described(family: str, kind: str, part: Any, given: Mapping[str, Any]) -> Promise:
    """Can a campaign name its options?"""
    what = "has options that a YAML can say"
    if refused := _refused(family, kind, part, given):
        return Promise(what, refused)
    known = list(options.model_of(part, registry.given(family, part)).model_fields)
    doc = inspect.getdoc(part)
    return Promise(what, note=(", ".join(known) or "none") + ("" if doc else "; it has no docstring"))


def _refused(family: str, kind: str, part: Any, given: Mapping[str, Any]) -> str:
    """What a campaign with this part would be told where it is read; empty if nothing.

    What a method that is a function answers when it is tried is left to its promises, which say more; not an option that it refuses.
    """
    try:
        SECTIONS[family].model_validate({"kind": kind, "options": dict(given)})
    except ValidationError as error:
        faults = faults_of(error, SECTIONS[family])
        if family == "method" and not inspect.isclass(part) and _is_described(family, part, given):
            faults = [fault for fault in faults if len(fault.loc) > 1]
        return "; ".join(f"{'.'.join(map(str, fault.loc[1:]))}: ".lstrip(": ") + fault.message for fault in faults)
    return ""


def _is_described(family: str, part: Any, given: Mapping[str, Any]) -> bool:
    """Are the options such as the signature of the part has them?"""
    try:
        options.checked(family, part, registry.given(family, part), given)
    except (options.OptionsError, ValidationError):
        return False
    return True
