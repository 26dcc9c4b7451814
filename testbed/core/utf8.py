"""Text that can be written: names of files, exceptions and other people's JSON may hold halves of characters, which no file can."""


def whole(text: str) -> str:
    """The text, a half of a character (a lone surrogate, such as a byte of a name that is not UTF-8) written as its number."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return text.encode("utf-8", "backslashreplace").decode()
    return text


MOST_SAID = 2_000
"""Characters of a message that others wrote; more is not read by anybody."""


def shortened(text: str, most: int = MOST_SAID) -> str:
    """The text, whole, and cut where it is longer than ``most`` characters."""
    return whole(text) if len(text) <= most else f"{whole(text[:most])} ... and {len(text) - most:,} characters more"


def clipped(text: str, most: int) -> str:
    """A name that has to fit: cut to ``most`` characters, the last of which then says so."""
    return text if len(text) <= most else f"{text[: most - 1]}\N{HORIZONTAL ELLIPSIS}"


def reason(bug: BaseException) -> str:
    """What an exception of anybody's code says: its type, and its text if that can be had."""
    try:
        said = str(bug)
    except BaseException as worse:  # its text is made by code, too
        said = f"its text cannot be read ({type(worse).__name__})"
    return shortened(f"{type(bug).__name__}: {said}")


def utf8(text: str) -> bytes:
    """The bytes of a text, whatever is in it."""
    return text.encode("utf-8", "backslashreplace")
