"""The wording of verdicts and places, in JSON and in tables."""

VERDICTS = ("pass", "warn", "fail", "error")
"""From best to worst; an error means that there is no grid to judge."""


def verdict_word(verdict: str) -> str:
    """Return a verdict for users: the word of JSON, a failure in capitals.

    >>> verdict_word("warn"), verdict_word("fail")
    ('warn', 'FAIL')
    """
    return verdict.upper() if verdict == "fail" else verdict


def named(at: tuple[int, ...]) -> str:
    """Return the place (i, j), (block, i, j) or (block, i, j, k) of a node or cell as text.

    >>> named((3, 0, 7)), named((0, 1, 2, 3))
    ('block=3, i=0, j=7', 'block=0, i=1, j=2, k=3')
    """
    names = ("i", "j") if len(at) == 2 else ("block", "i", "j", "k")
    return ", ".join(map("{}={}".format, names, at))
