"""What is asked: YAML in, validated campaigns and flight plans out."""

from testbed.spec.expand import expand
from testbed.spec.json_schema import schema
from testbed.spec.model import Campaign, FlightPlan
from testbed.spec.problems import SpecError
from testbed.spec.source import load_campaign

__all__ = ["Campaign", "FlightPlan", "SpecError", "expand", "load_campaign", "schema"]
