"""What checks and gates say of a grid, in the words of JSON and of tables."""

VERDICTS = ("pass", "warn", "fail", "error")
"""From best to worst; an error means that there is no grid to judge."""


def verdict_word(verdict: str) -> str:
    """Return a verdict for people: the word of JSON, that of a failure in capitals.

    >>> verdict_word("warn"), verdict_word("fail")
    ('warn', 'FAIL')
    """
    return verdict.upper() if verdict == "fail" else verdict
