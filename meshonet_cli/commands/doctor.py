"""``meshonet doctor``."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from meshonet_cli import options as o

if TYPE_CHECKING:
    from meshonet.api.doctor import Finding

EXAMPLES = ("meshonet doctor", "meshonet doctor --json")
_SIGNS = {True: "ok", False: "NO", None: "-"}  # printed result of a check: passed, failed, not applicable


def doctor(as_json: o.AsJson = False) -> int:
    """Check the installation and list what is missing.

    The exit code is 1 if something required is missing or does not work.
    """
    from meshonet.api.doctor import doctor as examined
    from meshonet_cli.terminal.session import Session

    session, findings = Session(as_json=as_json), examined()
    if as_json:
        session.result({"well": _well(findings), "findings": [vars(finding) for finding in findings]})
    else:
        session.print(findings_text(findings))
    return session.finish() or int(not _well(findings))


def _well(findings: "Sequence[Finding]") -> bool:
    return all(finding.well is not False for finding in findings)


def findings_text(findings: "Sequence[Finding]") -> str:
    """Return findings as text, one in each line, in groups, then the number of problems."""
    lines: list[str] = []
    width = max(len(finding.name) for finding in findings)
    for group in dict.fromkeys(finding.group for finding in findings):
        lines += ["", group] if lines else [group]
        for finding in (finding for finding in findings if finding.group == group):
            remedy = f"; {finding.remedy}" if finding.remedy and not finding.well else ""
            lines.append(f"  {_SIGNS[finding.well]:2}  {finding.name:<{width}}  {finding.value}{remedy}")
    ill = sum(finding.well is False for finding in findings)
    return "\n".join([*lines, "", f"{ill} of these need attention" if ill else "all is well"])
