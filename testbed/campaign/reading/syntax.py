"""The YAML parser's complaints in words for somebody who has never read the YAML specification."""

from ruamel.yaml.error import MarkedYAMLError

from testbed.campaign.reading.problems import Problem, Source

# What the parser's problem contains -> message, hint. The first that fits is used.
_PROBLEMS = (
    (r"'\t' that cannot start", "a tab", "YAML is indented with spaces"),
    ("that cannot start any token", "a value cannot start with this character", "put the text in quotes"),
    ("another document", "a second document starts here", "one campaign per file"),
    ("undefined alias", "this alias has no anchor before it", "write &name at the first place"),
    ("mapping values are not allowed", "a ':' where none can be", "check the indentation; a text with ': ' needs quotes"),
    ("could not find expected ':'", "expected 'key: value'", ""),
    ("expected <block end>", "the indentation does not match the lines above", ""),
    ("<document start>", "the indentation does not match the lines above", ""),
    ("expected the node content", "a value is missing here", ""),
    ("unknown escape character", "unknown escape in a quoted text", "'single quotes' know no escapes"),
)
# What the parser was in the middle of -> message. Its start is where the fault is; the parser notices much later.
_CONTEXTS = (
    ("flow sequence", "this '[' is not closed"),
    ("flow mapping", "this '{' is not closed"),
)


def explain(error: MarkedYAMLError, source: Source) -> Problem:
    """One problem, at the place where the user has to look."""
    context, problem = error.context or "", error.problem or "unreadable"
    mark = error.problem_mark or error.context_mark
    message, hint = f"not valid YAML: {problem}", ""
    if error.context_mark and "quoted scalar" in context and "escape" not in problem:
        mark, message = error.context_mark, "this quote is not closed"
    elif error.context_mark and (opened := [text for what, text in _CONTEXTS if what in context]):
        noticed = source.at(error.problem_mark.index) if error.problem_mark else None
        mark, message = error.context_mark, opened[0]
        if noticed and noticed.is_position and noticed.line > mark.line + 1:
            hint = f"noticed in line {noticed.line}"
    else:
        for part, text, advice in _PROBLEMS:
            if part in problem:
                message, hint = text, advice
                break
        if "could not find expected ':'" in problem and error.context_mark:
            mark = error.context_mark
    return Problem(source.at(mark.index) if mark else source.at(0), "", message, hint)
