"""The wording of verdicts, in JSON and in tables."""

VERDICTS = ("pass", "warn", "fail", "error")
"""Verdicts from best to worst; ``error``: there is no grid to judge."""


def verdict_word(verdict: str) -> str:
    """Return a verdict for users: the word of JSON, a failure in capitals.

    >>> verdict_word("warn"), verdict_word("fail")
    ('warn', 'FAIL')
    """
    return verdict.upper() if verdict == "fail" else verdict
