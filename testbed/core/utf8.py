"""Text that can be written: names of files, exceptions and other people's JSON may hold halves of characters, which no file can."""


def whole(text: str) -> str:
    """The text, a half of a character (a lone surrogate, such as a byte of a name that is not UTF-8) written as its number."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return text.encode("utf-8", "backslashreplace").decode()
    return text


def utf8(text: str) -> bytes:
    """The bytes of a text, whatever is in it."""
    return text.encode("utf-8", "backslashreplace")
