"""The vocabulary of a campaign, validated and frozen."""
