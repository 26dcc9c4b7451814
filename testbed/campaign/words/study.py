"""Which study a campaign belongs to: what judges its flights, and what it asks of their labels and settings."""

from collections.abc import Callable, Collection, Mapping
from enum import Enum
from typing import Any, ClassVar, Protocol

from pydantic import model_validator

from testbed.campaign.words.pluggable import Pluggable
from testbed.core import plugins, registry

NO_STUDY = "none"


class LabelKind(Enum):
    """What the labels of an axis are, where they are not a list of names."""

    ANY = "any text"
    NUMBER = "a number"
    AIRCRAFT = "the name of an aircraft"


Axes = Mapping[str, Collection[str] | LabelKind]
"""Axis to the labels that it may have. All axes are needed, and there are no others; labels may be left out."""

Labels = Mapping[str, Axes]
"""Part of the campaign (without parts an empty name) to its axes. A campaign may leave out a part."""


class Reads(Protocol):
    """What the reader of a campaign, and the identity of a flight, ask of a study: ``testbed.studies.study`` has all of it."""

    labels: ClassVar[Labels | None]
    flies: ClassVar[bool]
    formerly: ClassVar[Mapping[str, str]]
    unfit: Callable[..., str | None]


def spelt_out(written: Any) -> Any:
    """``study: scoam`` is short for ``study: {kind: scoam}``."""
    return {"kind": written} if isinstance(written, str) else written


class StudySpec(Pluggable):
    """What judges the flights of a campaign. One campaign has one kind; options can differ between its parts and cells."""

    family = "study"

    kind: str = NO_STUDY
    """none: the page shows what was flown. Another one writes files and a page, or the top of it, of its own; docs/ has a page of each."""

    @model_validator(mode="before")
    @classmethod
    def _options_are_always_tried(cls, written: Any) -> Any:
        """A study may need options; those that are missing are told also where none is written."""
        written = spelt_out(written)
        return {"options": {}, **written} if isinstance(written, dict) else written

    @classmethod
    def _try(cls, part: Any, options: dict[str, Any]) -> None:
        if not all(hasattr(part, name) for name in Reads.__annotations__):
            raise ValueError("is no study: derive it from testbed.studies.study.Study")
        part(**options)

    @property
    def part(self) -> type[Reads]:
        """The study, without its options."""
        found: type[Reads] = registry.part(self.family, self.kind)
        return found

    def made(self, pinned: Mapping[str, str] | None = None) -> Any:
        """The study with its options. ``pinned``: a plan's plug-ins."""
        return registry.part(self.family, self.kind, pinned)(**self.options)

    def unfit(self, settings: Mapping[str, Any]) -> str | None:
        """Why flights with these settings are nothing for the study; None if they are. Settings that are faulty themselves are absent."""
        if self.kind == NO_STUDY:
            return None
        why = self.made().unfit(settings)
        return f"the study '{self.kind}' {why}" if why else None


def formerly(key: str) -> str:
    """What to write instead of a key that campaigns had before there were studies; empty if it never was one."""
    for kind in registry.names("study"):
        try:
            renamed: Mapping[str, str] = registry.part("study", kind).formerly
        except plugins.PluginError:
            continue  # told to whoever asks for that study
        if key in renamed:
            return renamed[key]
    return ""
