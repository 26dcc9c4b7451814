"""What a process must know, besides the installed code, to fly a campaign: its plug-ins, and where its aircraft and data files are.

It goes with every flight, because a worker may have been started by somebody else, on another machine.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from testbed.campaign.reading.source import STORED_PLUGINS
from testbed.campaign.words.settings import Campaign
from testbed.core import datafiles, plugins
from testbed.core.catalogue import AIRCRAFT_ROOT, add_aircraft_path, aircraft_folders
from testbed.core.datafiles import DataFile
from testbed.core.plugins import Plugin
from testbed.run.directory import BadInputError, RunDirectory


@dataclass(frozen=True)
class World:
    """The plug-ins of a campaign, the folders in which its aircraft are found apart from the testbed's own, and its data files."""

    plugins: tuple[Plugin, ...] = ()
    aircraft_path: tuple[str, ...] = ()
    files: tuple[DataFile, ...] = ()

    def enter(self) -> None:
        """Make all of it known in this process; costs next to nothing when it is already. Raises ``PluginError``, ``OSError``."""
        plugins.add(self.plugins)
        datafiles.add(self.files)
        for root in self.aircraft_path:
            add_aircraft_path(Path(root))


NOTHING_MORE = World()


def world_of(campaign: Campaign, aircraft: Collection[str], pinned: Mapping[str, str]) -> World:
    """What the campaign, as it was just loaded in this process, needs to fly these aircraft. ``pinned``: its plans' ``plugins``."""
    files = [Path(name).stem for name in campaign.plugins]
    folders = aircraft_folders()
    roots = {folders[name].parent for name in sorted(aircraft)}
    elsewhere = sorted(str(root) for root in roots if root != AIRCRAFT_ROOT)
    return World(plugins.texts((name, plugins.sha256_of(name)) for name in files), tuple(elsewhere), datafiles.known(pinned.items()))


def store(directory: RunDirectory, world: World) -> None:
    """Write the plug-ins into the run directory, so that it can be read again whatever becomes of their files."""
    folder = directory / STORED_PLUGINS
    if world.plugins:
        folder.mkdir(exist_ok=True)
    for plugin in world.plugins:
        directory.put(f"{STORED_PLUGINS}/{plugin.name}.py", plugin.source.encode())


def stored_world(directory: RunDirectory, said: dict[str, str], aircraft_path: Sequence[str], files: Mapping[str, Sequence[str]]) -> World:
    """The world of a run that is there. ``said``: plug-in to its hash, as the manifest has it; ``files``: data file to its path and its
    hash. Raises ``BadInputError``.
    """
    found = []
    for name, sha256 in said.items():
        file = directory / STORED_PLUGINS / f"{name}.py"
        try:
            plugin = plugins.read(file)
        except plugins.PluginError as problem:
            raise BadInputError(f"{directory.path}: the plug-in of this run is gone: {problem}") from None
        if plugin.sha256 != sha256:
            raise BadInputError(f"{file}: changed since the run; the run was of another text (SHA-256 {sha256[:12]}...)")
        found.append(plugin)
    return World(tuple(found), tuple(aircraft_path), tuple(DataFile(name, *one) for name, one in files.items()))


def reenter(directory: RunDirectory, world: World) -> None:
    """Enter the world of a run that is there. Raises ``BadInputError``."""
    try:
        world.enter()
    except (plugins.PluginError, FileNotFoundError) as problem:
        raise BadInputError(f"{directory.path}: what this run needs cannot be had: {problem}") from None
