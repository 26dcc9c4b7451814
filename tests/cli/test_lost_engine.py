import pytest
from typer.testing import CliRunner

from testbed.cli import runs
from testbed.cli.shell import app
from testbed.run import runner
from testbed.run.engines import EngineLostError


@pytest.mark.parametrize("fresh", [False, True])
def test_a_cluster_that_is_lost_ends_the_run_with_the_command_that_goes_on(monkeypatch, fresh):
    def lost(_order):
        raise EngineLostError("the Dask scheduler at here is gone")

    arguments = ["run", "campaigns/smoke.yaml", "--workers", "1", *(["--fresh"] if fresh else [])]
    monkeypatch.setattr(runner, "run", lost)
    monkeypatch.setattr(runs.sys, "argv", ["testbed", *arguments])
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 130
    said = done.stderr.splitlines()
    assert said[-2:] == [
        "the Dask scheduler at here is gone; what was flown is kept. To go on:",
        "  testbed run campaigns/smoke.yaml --workers 1",
    ]
