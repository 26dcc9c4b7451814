"""What everything else stands on: units, frames, seeds, chains of curves, where aircraft are."""
