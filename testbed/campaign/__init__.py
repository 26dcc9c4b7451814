"""What is asked: YAML in, validated campaigns and flight plans out."""

from testbed.campaign.reading.expand import expand
from testbed.campaign.reading.json_schema import schema
from testbed.campaign.reading.problems import SpecError
from testbed.campaign.reading.source import load_campaign
from testbed.campaign.words.settings import Campaign, FlightPlan

__all__ = ["Campaign", "FlightPlan", "SpecError", "expand", "load_campaign", "schema"]
