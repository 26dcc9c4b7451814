"""The obstacles as they truly are."""
